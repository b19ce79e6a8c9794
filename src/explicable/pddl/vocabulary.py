"""What the names in a file stand for: types, objects, predicates, functions, requirements."""

from collections.abc import Iterable, Mapping

from explicable.model.problem import Function, Predicate
from explicable.pddl.source import Source

KEYWORDS = frozenset(("and", "or", "not", "imply", "exists", "forall", "when", "increase", "="))

_ADL = (
    ":strips",
    ":typing",
    ":equality",
    ":negative-preconditions",
    ":disjunctive-preconditions",
    ":existential-preconditions",
    ":universal-preconditions",
    ":conditional-effects",
)
REQUIREMENTS: Mapping[str, tuple[str, ...]] = {
    **{name: (name,) for name in (*_ADL, ":action-costs")},
    ":adl": _ADL,
    ":quantified-preconditions": (":existential-preconditions", ":universal-preconditions"),
    ":negation": (":negative-preconditions",),
    # Numbers are read as far as action costs go; any other use is refused where it stands.
    ":fluents": (":action-costs",),
    ":numeric-fluents": (":action-costs",),
}


class Requirements:
    """What a file may use, and one warning for each feature that it uses without saying so."""

    __slots__ = ("_met", "_source", "declared")

    def __init__(self, declared: Iterable[str], source: Source) -> None:
        self.declared = frozenset(declared)
        self._met = {feature for name in self.declared for feature in REQUIREMENTS.get(name, ())}
        self._source = source

    def use(self, feature: str, offset: int) -> None:
        """Note that a feature is used at an offset."""
        if feature not in self._met:
            self._met.add(feature)
            self._source.warn(f"'{feature}' is used but not required", offset)


class Vocabulary:
    """The names that formulas may use.

    Parameters
    ----------
    ancestors
        Each type with all its supertypes, itself and ``object`` included.
    objects
        Each constant and object with its types.
    """

    __slots__ = ("_members", "ancestors", "functions", "objects", "predicates")

    def __init__(
        self,
        ancestors: Mapping[str, frozenset[str]],
        objects: Mapping[str, tuple[str, ...]],
        predicates: Iterable[Predicate],
        functions: Iterable[Function],
    ) -> None:
        self.ancestors = ancestors
        self.objects = objects
        self.predicates = {predicate.name: predicate for predicate in predicates}
        self.functions = {function.name: function for function in functions}
        self._members: dict[tuple[str, ...], dict[str, str]] = {}

    def fits(self, types: tuple[str, ...], wanted: tuple[str, ...]) -> bool:
        """Say whether whatever is of one of `types` is surely of one of those wanted."""
        return "object" in wanted or all(not self.ancestors[kind].isdisjoint(wanted) for kind in types)

    def members(self, wanted: tuple[str, ...]) -> dict[str, str]:
        """Map the name of each object that may stand where `wanted` is asked for to itself.

        One table serves as check and as the shared copy of each name.
        """
        if wanted not in self._members:
            kinds = {types for types in set(self.objects.values()) if self.belongs(types, wanted)}
            self._members[wanted] = {name: name for name, types in self.objects.items() if types in kinds}
        return self._members[wanted]

    def belongs(self, types: tuple[str, ...], wanted: tuple[str, ...]) -> bool:
        """Say whether an object of these types (of each of them, if several) is of one of those wanted."""
        return "object" in wanted or any(not self.ancestors[kind].isdisjoint(wanted) for kind in types)

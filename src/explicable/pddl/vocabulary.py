"""What the names in a file stand for: types, objects, predicates, functions, requirements."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from explicable.errors import UnsupportedFeatureError
from explicable.model.problem import Function, Predicate
from explicable.pddl.source import MAX_NESTING, Cursor, Source

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


def read_requirements(cursor: Cursor) -> frozenset[str]:
    """Read the rest of ``(:requirements ...)``."""
    declared = set()
    while not cursor.closes():
        if cursor.ahead not in REQUIREMENTS:
            if cursor.ahead.startswith(":"):
                raise cursor.error(f"requirement '{cursor.ahead}' is not supported", UnsupportedFeatureError)
            raise cursor.error(f"expected a requirement, not {cursor.shown}")
        declared.add(cursor.take())
    cursor.take()
    return frozenset(declared)


class Typed(NamedTuple):
    """One entry of a typed list, with the place where it stands."""

    name: str
    types: tuple[str, ...]
    offset: int


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
            self._members[wanted] = {
                name: name for name, types in self.objects.items() if self.belongs(types, wanted)
            }
        return self._members[wanted]

    def belongs(self, types: tuple[str, ...], wanted: tuple[str, ...]) -> bool:
        """Say whether an object of these types (of each of them, if several) is of one of those wanted."""
        return "object" in wanted or any(not self.ancestors[kind].isdisjoint(wanted) for kind in types)


def read_typed_list(
    cursor: Cursor,
    what: str,
    requirements: Requirements,
    ancestors: Mapping[str, frozenset[str]] | None,
) -> list[Typed]:
    """Read ``name ... - type name ...`` and its closing bracket.

    `what` says what is listed; ``a variable`` asks for variables. Types are checked against `ancestors`,
    unless that is None.
    """
    entries: list[Typed] = []
    untyped: list[tuple[str, int]] = []
    while not cursor.closes():
        if cursor.ahead == "-":
            cursor.take()
            requirements.use(":typing", cursor.taken)
            types = _read_types(cursor, ancestors)
            entries.extend(Typed(name, types, offset) for name, offset in untyped)
            untyped.clear()
        else:
            name = cursor.take_variable() if what == "a variable" else cursor.take_name(what)
            untyped.append((name, cursor.taken))
    cursor.take()
    entries.extend(Typed(name, ("object",), offset) for name, offset in untyped)
    return entries


def _read_types(cursor: Cursor, ancestors: Mapping[str, frozenset[str]] | None) -> tuple[str, ...]:
    if cursor.ahead != "(":
        return (_read_type(cursor, ancestors),)
    cursor.take()
    if cursor.ahead != "either":
        raise cursor.error(f"expected a type or '(either ...)', not {cursor.shown}")
    cursor.take()
    types = [_read_type(cursor, ancestors)]
    while not cursor.closes():
        types.append(_read_type(cursor, ancestors))
    cursor.take()
    return tuple(types)


def _read_type(cursor: Cursor, ancestors: Mapping[str, frozenset[str]] | None) -> str:
    name = cursor.take_name("a type")
    if ancestors is not None and name not in ancestors:
        raise cursor.error_at_taken(f"undeclared type '{name}'")
    return name


def read_types(cursor: Cursor, requirements: Requirements) -> dict[str, tuple[str, ...]]:
    """Read the rest of ``(:types ...)``: each type with its parents."""
    source = cursor.source
    types: dict[str, tuple[str, ...]] = {}
    entries = read_typed_list(cursor, "a type", requirements, None)
    for name, parents, offset in entries:
        if name == "object":
            if parents != ("object",):
                raise source.error("type 'object' can't have a parent", offset)
        elif types.get(name, ("object",)) == ("object",) != parents or name not in types:
            # IPC storage lists a type under 'object' first and under its real parent later.
            types[name] = parents
        else:
            raise source.error(f"type '{name}' is declared twice", offset)
    for name, parents, offset in entries:
        for parent in parents:
            if parent not in types and parent != "object":
                raise source.error(f"undeclared type '{parent}', the parent of '{name}'", offset)
    _check_hierarchy(entries, types, source)
    return types


def _check_hierarchy(entries: list[Typed], types: Mapping[str, tuple[str, ...]], source: Source) -> None:
    """Refuse cycles, and hierarchies deeper than any real one."""
    heights = {"object": 0}  # how many types stand above one

    def measure(name: str, below: list[str], offset: int) -> int:
        if name in below:
            raise source.error(f"type '{name}' is its own ancestor", offset)
        if len(below) >= MAX_NESTING or heights.get(name, 0) >= MAX_NESTING:
            raise source.error(f"types are nested deeper than {MAX_NESTING}", offset)
        if name not in heights:
            heights[name] = 1 + max(measure(parent, [*below, name], offset) for parent in types[name])
        return heights[name]

    for name, _, offset in entries:
        measure(name, [], offset)

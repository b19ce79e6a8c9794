"""Lifted planning models: domains and problems as written in PDDL.

Everything here is a frozen value. Names are lower case. A term is a string: a variable begins with ``?``,
anything else names an object. A ground atom is a plain tuple ``(predicate, object, ...)``.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

GroundAtom = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A typed variable; more than one type means ``(either ...)``."""

    name: str
    types: tuple[str, ...] = ("object",)


@dataclass(frozen=True, slots=True)
class Predicate:
    """A declared predicate."""

    name: str
    parameters: tuple[Parameter, ...]


@dataclass(frozen=True, slots=True)
class Function:
    """A declared numeric function, used for action costs only."""

    name: str
    parameters: tuple[Parameter, ...]


@dataclass(frozen=True, slots=True)
class Atom:
    """``(predicate term ...)``; equality is the predicate ``=``."""

    predicate: str
    terms: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Not:
    """Negation of any formula."""

    body: "Formula"


@dataclass(frozen=True, slots=True)
class And:
    """Conjunction; with no parts it is true."""

    parts: tuple["Formula", ...] = ()


@dataclass(frozen=True, slots=True)
class Or:
    """Disjunction; with no parts it is false. ``imply`` is read as one."""

    parts: tuple["Formula", ...] = ()


@dataclass(frozen=True, slots=True)
class Exists:
    """Existential quantification; its parameters hide outer variables of the same name."""

    parameters: tuple[Parameter, ...]
    body: "Formula"


@dataclass(frozen=True, slots=True)
class Forall:
    """Universal quantification; its parameters hide outer variables of the same name."""

    parameters: tuple[Parameter, ...]
    body: "Formula"


Formula = Atom | Not | And | Or | Exists | Forall
TRUE = And()


@dataclass(frozen=True, slots=True)
class Effect:
    """``(forall (parameters) (when condition [not] atom))``.

    A plain effect has no parameters and a true condition. A parameter hides the action's of the same name.
    """

    atom: Atom
    positive: bool = True
    condition: Formula = TRUE
    parameters: tuple[Parameter, ...] = ()


@dataclass(frozen=True, slots=True)
class FunctionTerm:
    """``(function term ...)`` as the amount of a cost increase."""

    name: str
    terms: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ActionSchema:
    """An action as written.

    It costs the sum of ``cost``, or 1 where the problem does not minimise cost.
    """

    name: str
    parameters: tuple[Parameter, ...]
    precondition: Formula
    effects: tuple[Effect, ...]
    cost: tuple[int | FunctionTerm, ...] = ()


@dataclass(frozen=True, slots=True)
class Domain:
    """A planning domain.

    ``types`` maps each declared type to its parents (several for ``either``); ``object`` is the root and not
    listed. ``constants`` maps each constant to its types; it belongs to each of them.
    """

    name: str
    requirements: frozenset[str]
    types: Mapping[str, tuple[str, ...]]
    constants: Mapping[str, tuple[str, ...]]
    predicates: tuple[Predicate, ...]
    functions: tuple[Function, ...]
    actions: tuple[ActionSchema, ...]


@dataclass(frozen=True, slots=True)
class Problem:
    """A planning problem over a domain.

    ``objects`` does not repeat the domain's constants. ``init`` holds the atoms that are true at the start;
    ``values`` the initial numbers, among them what actions cost. ``minimize_cost`` says whether the metric is
    ``total-cost``; otherwise each step costs 1.
    """

    name: str
    domain: Domain
    objects: Mapping[str, tuple[str, ...]]
    init: tuple[GroundAtom, ...]
    goal: Formula
    values: Mapping[GroundAtom, int]
    minimize_cost: bool = False


def conjuncts(formula: Formula) -> Iterator[Formula]:
    """Yield the parts of a conjunction, however nested; of any other formula, itself.

    Examples
    --------
    >>> [part.predicate for part in conjuncts(And((Atom("a", ()), And((Atom("b", ()),)))))]
    ['a', 'b']
    """
    if isinstance(formula, And):
        for part in formula.parts:
            yield from conjuncts(part)
    else:
        yield formula


def ancestors(types: Mapping[str, tuple[str, ...]]) -> dict[str, frozenset[str]]:
    """Give each type with all its supertypes, itself and ``object`` included.

    Parameters
    ----------
    types
        Each type with its parents, as in ``Domain.types``.

    Examples
    --------
    >>> sorted(ancestors({"truck": ("vehicle",), "vehicle": ("object",)})["truck"])
    ['object', 'truck', 'vehicle']
    """
    return {name: _upwards(types, (name,)) for name in ("object", *types)}


def supertypes(domain: Domain, types: Iterable[str]) -> frozenset[str]:
    """Give all types that an object of the given types has, ``object`` included.

    Examples
    --------
    >>> domain = Domain("d", frozenset(), {"truck": ("vehicle",), "vehicle": ("object",)}, {}, (), (), ())
    >>> sorted(supertypes(domain, ["truck"]))
    ['object', 'truck', 'vehicle']
    """
    return _upwards(domain.types, types)


def object_types(problem: Problem) -> dict[str, frozenset[str]]:
    """Give each object, constants included, with all types that it has, ``object`` included.

    Examples
    --------
    >>> domain = Domain("d", frozenset(), {"truck": ("object",)}, {}, (), (), ())
    >>> sorted(object_types(Problem("p", domain, {"t": ("truck",)}, (), TRUE, {}))["t"])
    ['object', 'truck']
    """
    objects = {**problem.domain.constants, **problem.objects}
    above = {types: supertypes(problem.domain, types) for types in set(objects.values())}  # few for thousands
    return {name: above[types] for name, types in objects.items()}


def _upwards(types: Mapping[str, tuple[str, ...]], names: Iterable[str]) -> frozenset[str]:
    above, pending = {"object"}, list(names)
    while pending:
        name = pending.pop()
        if name not in above:
            above.add(name)
            pending.extend(types.get(name, ()))
    return frozenset(above)

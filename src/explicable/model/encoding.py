"""A lifted problem as flat arrays of integers, as the compiled grounder reads it.

Objects are numbered, the domain's constants first. A term is the number of a variable, or ``~object``;
variables are numbered by scope: the action's parameters, then those of the quantifiers around.
"""

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from explicable.errors import UsageError
from explicable.model.problem import (
    ActionSchema,
    And,
    Atom,
    Effect,
    Exists,
    Forall,
    Formula,
    FunctionTerm,
    Not,
    Or,
    Parameter,
    Problem,
    object_types,
)

_ATOM, _EQUALITY, _NOT, _AND, _OR, _EXISTS, _FORALL = range(7)
_TOTAL_COST = "total-cost"

Scope = dict[str, int]


@dataclass(frozen=True, slots=True)
class EncodedProblem:
    """What the compiled grounder reads.

    ``initial`` holds, predicate by predicate, the arguments of the atoms that are true at the start, one
    after the other, ``num_initial`` their number; ``function_arguments`` and ``function_values`` the same
    for numbers.
    """

    objects: tuple[str, ...]
    structure: "array[int]"
    initial: "list[array[int]]"
    num_initial: list[int]
    function_arguments: "list[array[int]]"
    function_values: "list[array[int]]"


def encode(problem: Problem) -> EncodedProblem:
    """Encode a problem: number everything in it.

    Raises
    ------
    UsageError
        If the problem names something that it does not declare.

    Examples
    --------
    >>> from explicable.model.problem import Domain
    >>> domain = Domain("empty", frozenset(), {}, {}, (), (), ())
    >>> encode(Problem("p", domain, {"a": ("object",)}, (), And(), {})).objects
    ('a',)
    """
    try:
        return _Encoder(problem).encode()
    except KeyError as error:
        raise UsageError(f"problem {problem.name} does not declare {error.args[0]!r}") from error
    except OverflowError as error:
        raise UsageError(f"problem {problem.name} has a number beyond 2147483647") from error
    except RecursionError as error:
        raise UsageError(f"problem {problem.name} has a formula that is nested too deeply") from error


class _Encoder:
    def __init__(self, problem: Problem) -> None:
        domain = problem.domain
        self.problem = problem
        self.types = {**domain.constants, **problem.objects}
        self.object_numbers = {name: number for number, name in enumerate(self.types)}
        self.predicate_numbers = {p.name: number for number, p in enumerate(domain.predicates)}
        self.functions = tuple(f for f in domain.functions if f.name != _TOTAL_COST)
        self.function_numbers = {f.name: number for number, f in enumerate(self.functions)}
        self.members = _objects_by_type(problem)
        self.domains: dict[tuple[str, ...], int] = {}
        self.stream = array("i")

    def encode(self) -> EncodedProblem:
        domain = self.problem.domain
        self.stream.append(len(domain.actions))
        for action in domain.actions:
            self.action(action)
        self.formula(self.problem.goal, {})
        head = self.head()
        initial, num_initial = self.initial_atoms()
        arguments, values = self.function_values()
        return EncodedProblem(tuple(self.types), head + self.stream, initial, num_initial, arguments, values)

    def head(self) -> "array[int]":
        domain = self.problem.domain
        head = array("i", [len(self.types), len(self.domains)])
        for types in self.domains:
            objects = sorted({number for name in types for number in self.members[name]})
            head.append(len(objects))
            head.extend(objects)
        for symbols in (domain.predicates, self.functions):
            head.append(len(symbols))
            head.extend(len(symbol.parameters) for symbol in symbols)
        return head

    def variables(self, parameters: Sequence[Parameter], scope: Scope) -> Scope:
        self.stream.append(len(parameters))
        self.stream.extend(self.domains.setdefault(p.types, len(self.domains)) for p in parameters)
        first = scope.get("", 0)  # "" counts: an inner variable may hide an outer one of the same name
        inner = scope | {p.name: first + i for i, p in enumerate(parameters)}
        inner[""] = first + len(parameters)
        return inner

    def terms(self, terms: Iterable[str], scope: Scope) -> None:
        self.stream.extend(
            scope[term] if term.startswith("?") else ~self.object_numbers[term] for term in terms
        )

    def atom(self, atom: Atom, scope: Scope) -> None:
        self.stream.append(self.predicate_numbers[atom.predicate])
        self.terms(atom.terms, scope)

    def formula(self, formula: Formula, scope: Scope) -> None:
        match formula:
            case Atom("=", terms):
                self.stream.append(_EQUALITY)
                self.terms(terms, scope)
            case Atom():
                self.stream.append(_ATOM)
                self.atom(formula, scope)
            case Not(body):
                self.stream.append(_NOT)
                self.formula(body, scope)
            case And(parts) | Or(parts):
                self.stream.extend((_AND if isinstance(formula, And) else _OR, len(parts)))
                for part in parts:
                    self.formula(part, scope)
            case Exists(parameters, body) | Forall(parameters, body):
                self.stream.append(_EXISTS if isinstance(formula, Exists) else _FORALL)
                self.formula(body, self.variables(parameters, scope))

    def action(self, action: ActionSchema) -> None:
        scope = self.variables(action.parameters, {})
        self.formula(action.precondition, scope)
        self.stream.append(len(action.effects))
        for effect in action.effects:
            self.effect(effect, scope)
        terms = [part for part in action.cost if isinstance(part, FunctionTerm)]
        constant = sum(part for part in action.cost if isinstance(part, int))
        self.stream.append(constant if self.problem.minimize_cost else 1)
        if not self.problem.minimize_cost:
            terms = []
        self.stream.append(len(terms))
        for term in terms:
            self.stream.append(self.function_numbers[term.name])
            self.terms(term.terms, scope)

    def effect(self, effect: Effect, scope: Scope) -> None:
        inner = self.variables(effect.parameters, scope)
        self.formula(effect.condition, inner)
        self.stream.append(int(effect.positive))
        self.atom(effect.atom, inner)

    def initial_atoms(self) -> "tuple[list[array[int]], list[int]]":
        arguments: dict[str, list[str]] = {name: [] for name in self.predicate_numbers}
        counts = dict.fromkeys(arguments, 0)
        for atom in self.problem.init:
            arguments[atom[0]].extend(atom[1:])
            counts[atom[0]] += 1
        number = self.object_numbers.__getitem__
        return [array("i", map(number, names)) for names in arguments.values()], list(counts.values())

    def function_values(self) -> "tuple[list[array[int]], list[array[int]]]":
        arguments = [array("i") for _ in self.functions]
        values = [array("i") for _ in self.functions]
        for (name, *objects), value in self.problem.values.items():
            if name != _TOTAL_COST:
                function = self.function_numbers[name]
                arguments[function].extend(self.object_numbers[name] for name in objects)
                values[function].append(value)
        return arguments, values


def _objects_by_type(problem: Problem) -> dict[str, list[int]]:
    members: dict[str, list[int]] = {name: [] for name in ("object", *problem.domain.types)}
    for number, above in enumerate(object_types(problem).values()):
        for name in above:
            members[name].append(number)
    return members

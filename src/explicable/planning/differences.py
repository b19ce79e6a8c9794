"""Where the person's model of the robots differs from the robots' own, one small difference at a time.

These are the model updates of Chakraborti, Sreedharan, Zhang & Kambhampati, "Plan explanations as model
reconciliation: moving beyond explanation as soliloquy" (IJCAI 2017): initial facts, preconditions, effects
and costs, each of which the person can be told. What humans can do and what is to be reached are no matter of
telling, so differences in them do not count.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from explicable.model.explanation import format_formula
from explicable.model.plan import format_action
from explicable.model.problem import (
    TRUE,
    ActionSchema,
    And,
    Domain,
    Effect,
    Formula,
    FunctionTerm,
    GroundAtom,
    Not,
    Problem,
)
from explicable.model.team import TeamProblem, schema_kind
from explicable.planning.schemas import conjuncts, renamed, terms


@dataclass(frozen=True, slots=True)
class FactDifference:
    """An atom that really holds at the start, or does not, while the person believes the contrary.

    Examples
    --------
    >>> print(FactDifference(("locked", "hall", "store"), holds=True))
    (locked hall store) holds
    """

    atom: GroundAtom
    holds: bool

    @property
    def names(self) -> frozenset[str]:
        """The objects that it is about."""
        return frozenset(self.atom[1:])

    def __str__(self) -> str:
        return f"{format_action(self.atom)} {'holds' if self.holds else 'does not hold'}"


@dataclass(frozen=True, slots=True)
class ValueDifference:
    """A number that the person takes to be another, such as the length of a way."""

    term: GroundAtom
    value: int

    @property
    def names(self) -> frozenset[str]:
        """The objects that it is about."""
        return frozenset(self.term[1:])

    def __str__(self) -> str:
        return f"{format_action(self.term)} is {self.value}"


@dataclass(frozen=True, slots=True)
class SchemaDifference:
    """One precondition, one effect or the cost of an action, or the whole of it.

    Parameters
    ----------
    schema
        Name of the action.
    part
        What differs: a conjunct of the precondition, an effect, the terms of the cost, or a whole schema.
    present
        Whether the robots' own model has that part, or only the person's does.
    """

    schema: str
    part: Formula | Effect | tuple[int | FunctionTerm, ...] | ActionSchema
    present: bool = True

    @property
    def names(self) -> frozenset[str]:
        """The action that it is about."""
        return frozenset((self.schema,))

    def __str__(self) -> str:
        match self.part:
            case ActionSchema():
                return f"{self.schema} is {'an' if self.present else 'no'} action as the robots know it"
            case Effect(atom, positive, condition, _):
                written = format_formula(atom if positive else Not(atom), {})
                when = "" if condition == TRUE else f" when {format_formula(condition, {})}"
                return f"{self.schema} {'makes' if self.present else 'does not make'} {written}{when}"
            case tuple(amounts):
                words = (str(a) if isinstance(a, int) else format_action((a.name, *a.terms)) for a in amounts)
                return f"{self.schema} costs {' + '.join(words) or 'nothing'}"
            case formula:
                verb = "needs" if self.present else "does not need"
                return f"{self.schema} {verb} {format_formula(formula, {})}"


Difference = FactDifference | ValueDifference | SchemaDifference


def find_differences(problem: TeamProblem) -> tuple[Difference, ...]:
    """List what the person could be told of the robots' model.

    Facts come first, then numbers, then actions. Facts of predicates that the robots' model does not have are
    left out: nothing is known of them.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> [str(difference) for difference in find_differences(encode(World(("@x*", "..o"))))]
    ['(clear c-0-1) does not hold']
    """
    robot, human = problem.robot, problem.mental
    own, theirs = frozenset(robot.init), frozenset(human.init)
    known = {predicate.name for predicate in robot.domain.predicates}
    facts = sorted(atom for atom in own ^ theirs if atom[0] in known)
    values = sorted(
        (term, value)
        for term, value in robot.values.items()
        if term[0] != "total-cost" and human.values.get(term) != value
    )
    return (
        *(FactDifference(atom, holds=atom in own) for atom in facts),
        *(ValueDifference(term, value) for term, value in values),
        *_schema_differences(robot.domain, human.domain),
    )


def correct(problem: TeamProblem, told: Iterable[Difference]) -> TeamProblem:
    """Return the team problem after the person was told of some differences.

    What the robots and humans can really do, the composite task, stays the same.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> team = encode(World(("@x*", "..o")))
    >>> find_differences(correct(team, find_differences(team)))
    ()
    """
    human = _declare(problem.mental, problem.robot, told := tuple(told))
    init = dict.fromkeys(human.init)
    values = dict(human.values)
    schemas = {schema.name: schema for schema in human.domain.actions}
    own = {schema.name: schema for schema in problem.robot.domain.actions}
    for difference in told:
        match difference:
            case FactDifference(atom, holds=True):
                init[atom] = None
            case FactDifference(atom):
                init.pop(atom, None)
            case ValueDifference(term, value):
                values[term] = value
            case SchemaDifference(name, ActionSchema() as whole, present):
                if present:
                    schemas[name] = whole
                else:
                    del schemas[name]
            case SchemaDifference(name):
                schema = renamed(schemas[name], own[name])
                if schema is not None:
                    schemas[name] = _corrected(schema, difference)
    domain = replace(human.domain, actions=tuple(schemas.values()))
    return replace(problem, human=replace(human, domain=domain, init=tuple(init), values=values))


def _corrected(schema: ActionSchema, difference: SchemaDifference) -> ActionSchema:
    """Put a part into a schema, or take it out."""
    match difference.part:
        case Effect() as effect:
            others = tuple(other for other in schema.effects if other != effect)
            return replace(schema, effects=(*others, effect) if difference.present else others)
        case tuple(cost):
            return replace(schema, cost=cost)
        case formula:
            parts = tuple(part for part in conjuncts(schema.precondition) if part != formula)
            return replace(
                schema,
                precondition=And((*parts, formula) if difference.present else parts),  # type: ignore[arg-type]
            )


def _declare(human: Problem, robot: Problem, told: Iterable[Difference]) -> Problem:
    """Declare what telling needs words for; without facts, types and predicates mean nothing yet."""
    domain = human.domain
    predicates = {predicate.name for predicate in domain.predicates}
    functions = {function.name for function in domain.functions}
    known = {*human.objects, *domain.constants}
    everything = {**robot.domain.constants, **robot.objects}
    named = {name for difference in told for name in _objects(difference)}
    return replace(
        human,
        domain=replace(
            domain,
            types={**robot.domain.types, **domain.types},
            predicates=(
                *domain.predicates,
                *(p for p in robot.domain.predicates if p.name not in predicates),
            ),
            functions=(*domain.functions, *(f for f in robot.domain.functions if f.name not in functions)),
        ),
        objects={
            **human.objects,
            **{name: types for name, types in everything.items() if name in named - known},
        },
    )


def _objects(difference: Difference) -> Iterator[str]:
    """Names of objects that a difference mentions: constants, where it is one of schemas."""
    if not isinstance(difference, SchemaDifference):
        yield from difference.names
        return
    match difference.part:
        case ActionSchema(_, _, precondition, effects):
            formulas = [precondition, *(f for e in effects for f in (e.atom, e.condition))]
        case Effect(atom, _, condition):
            formulas = [atom, condition]
        case tuple():
            formulas = []
        case formula:
            formulas = [formula]
    for formula in formulas:
        yield from (term for term in terms(formula) if not term.startswith("?"))


def _schema_differences(own: Domain, theirs: Domain) -> Iterator[SchemaDifference]:
    believed = {schema.name: schema for schema in theirs.actions if schema_kind(theirs, schema) == "robot"}
    true = {schema.name: schema for schema in own.actions if schema_kind(own, schema) == "robot"}
    for name, schema in true.items():
        other = renamed(believed[name], schema) if name in believed else None
        if other is None:
            yield SchemaDifference(name, schema)
        else:
            yield from _part_differences(schema, other)
    for name in sorted(believed.keys() - true.keys()):
        yield SchemaDifference(name, believed[name], present=False)


def _part_differences(own: ActionSchema, theirs: ActionSchema) -> Iterator[SchemaDifference]:
    pairs: tuple[tuple[tuple[Formula | Effect, ...], tuple[Formula | Effect, ...]], ...] = (
        (tuple(conjuncts(own.precondition)), tuple(conjuncts(theirs.precondition))),
        (own.effects, theirs.effects),
    )
    for mine, believed in pairs:
        yield from (SchemaDifference(own.name, part) for part in mine if part not in believed)
        yield from (SchemaDifference(own.name, part, present=False) for part in believed if part not in mine)
    if own.cost != theirs.cost:
        yield SchemaDifference(own.name, own.cost)

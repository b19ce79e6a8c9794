"""Where the person's model of the robots differs from the robots' own, one small difference at a time.

These are the model updates of Chakraborti, Sreedharan, Zhang & Kambhampati, "Plan explanations as model
reconciliation: moving beyond explanation as soliloquy" (IJCAI 2017): initial facts, preconditions, effects
and costs, each of which the person can be told. What humans can do and what is to be reached are no matter of
telling, so differences in them do not count.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from explicable.model.explanation import format_formula, format_types
from explicable.model.plan import format_action
from explicable.model.problem import (
    TRUE,
    ActionSchema,
    Domain,
    Effect,
    Formula,
    FunctionTerm,
    GroundAtom,
    Not,
    Problem,
    conjuncts,
)
from explicable.model.team import TeamProblem, schema_kind
from explicable.planning.schemas import renamed


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
            case ActionSchema(name, parameters):
                form = " ".join((name, *(f"{p.name} - {format_types(p.types)}" for p in parameters)))
                return f"there is {'an action' if self.present else 'no action'} ({form})"
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
        *_schema_differences(_schemas_of("robot", robot.domain), _schemas_of("robot", human.domain)),
    )


@dataclass(frozen=True, slots=True)
class NameDifference:
    """A type, object, predicate or function that only one of the two models has.

    Examples
    --------
    >>> print(NameDifference("predicate", "memory-free", in_robots=True))
    predicate memory-free is unknown to the person
    """

    kind: str
    name: str
    in_robots: bool

    def __str__(self) -> str:
        return f"{self.kind} {self.name} is unknown to the {'person' if self.in_robots else 'robots'}"


@dataclass(frozen=True, slots=True)
class GoalDifference:
    """A part of the goal that only one of the two models has; the robots' goal is the team's."""

    part: Formula
    in_robots: bool

    def __str__(self) -> str:
        whose = "robots" if self.in_robots else "person"
        return f"{format_formula(self.part, {})} is a goal to the {whose} alone"


@dataclass(frozen=True, slots=True)
class Comparison:
    """All in which the two models of a team differ.

    Attributes
    ----------
    tellable
        What the person could be told of the robots' model; see `find_differences`.
    names
        What only one of the two has a name for.
    goals
        Where the person has another goal in mind. The team's is the robots'.
    human_actions
        Where the robots' file describes humans' actions otherwise than the human's does. The human's counts.
    """

    tellable: tuple[Difference, ...]
    names: tuple[NameDifference, ...]
    goals: tuple[GoalDifference, ...]
    human_actions: tuple[SchemaDifference, ...]


def compare(problem: TeamProblem) -> Comparison:
    """Compare the two models of a team.

    Differences are allowed: planning is about them. Names that the two use for different things are not; see
    `explicable.model.team.find_conflicts`.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> compare(encode(World(("@x*", "..o")))).names
    ()
    """
    robot, human = problem.robot, problem.mental
    names = [
        NameDifference(kind, name, in_robots=name in own)
        for (kind, own), theirs in zip(_declared(robot).items(), _declared(human).values(), strict=True)
        for name in (*(n for n in own if n not in theirs), *(n for n in theirs if n not in own))
    ]
    parts, believed = tuple(conjuncts(robot.goal)), tuple(conjuncts(human.goal))
    goals = [
        *(GoalDifference(part, in_robots=True) for part in parts if part not in believed),
        *(GoalDifference(part, in_robots=False) for part in believed if part not in parts),
    ]
    by_robots, by_human = _schemas_of("human", robot.domain), _schemas_of("human", human.domain)
    human_actions = _schema_differences(by_human, by_robots) if by_robots and by_human else ()
    return Comparison(find_differences(problem), tuple(names), tuple(goals), tuple(human_actions))


def _declared(problem: Problem) -> dict[str, dict[str, None]]:
    """Names of each kind, in their order; large maps have tens of thousands."""
    domain = problem.domain
    return {
        "type": dict.fromkeys(domain.types),
        "object": dict.fromkeys((*domain.constants, *problem.objects)),
        "predicate": dict.fromkeys(predicate.name for predicate in domain.predicates),
        "function": dict.fromkeys(function.name for function in domain.functions),
    }


def _schemas_of(kind: Literal["robot", "human"], domain: Domain) -> Mapping[str, ActionSchema]:
    return {schema.name: schema for schema in domain.actions if schema_kind(domain, schema) == kind}


def _schema_differences(
    true: Mapping[str, ActionSchema], believed: Mapping[str, ActionSchema]
) -> Iterator[SchemaDifference]:
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

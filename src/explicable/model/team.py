"""Teams: who acts, and the composition of the robot's and the human's model into one problem."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from explicable.errors import ConflictError, PDDLError
from explicable.model.explanation import format_types
from explicable.model.problem import (
    ActionSchema,
    Domain,
    Function,
    GroundAtom,
    Predicate,
    Problem,
    ancestors,
    object_types,
    supertypes,
)

if TYPE_CHECKING:
    from explicable.model.task import Task

DEFAULT_ROBOT = "robot"


@dataclass(frozen=True, slots=True)
class Agent:
    """A member of the team."""

    name: str
    kind: Literal["robot", "human"]


@dataclass(frozen=True)
class TeamProblem:
    """What the robot plans for: ``<I, G, M_R, ~M_H>`` of the paper.

    Parameters
    ----------
    robot
        The robot's own model ``M_R``, with the true initial state and the goal.
    human
        The approximate human planning model ``~M_H``: the person's own actions, what the person believes that
        the robot can do, and the initial state that the person believes in. None: the same as the robot's.
    """

    robot: Problem
    human: Problem | None = None

    @property
    def mental(self) -> Problem:
        """The problem as the robot thinks that the person sees it."""
        return self.human or self.robot

    @cached_property
    def composite(self) -> Problem:
        """The joint problem: robots' actions from ``M_R``, humans' from ``~M_H``, over shared facts.

        Raises
        ------
        ConflictError
            If the two models use the same name for different things.
        """
        return self.robot if self.human is None else compose(self.robot, self.human)

    @cached_property
    def agents(self) -> tuple[Agent, ...]:
        """The team's members in the order of declaration; a lone default robot where no object is a robot.

        Raises
        ------
        PDDLError
            If an object is both a robot and a human.
        """
        if undecided := find_undecided(self.composite):
            raise PDDLError(explain_undecided(undecided[0]))
        agents = [Agent(name, kind) for name, kind in agent_kinds(self.composite).items() if kind]
        if not any(agent.kind == "robot" for agent in agents):
            agents.insert(0, Agent(DEFAULT_ROBOT, "robot"))
        return tuple(agents)

    @cached_property
    def _agent_by_name(self) -> dict[str, Agent]:
        return {agent.name: agent for agent in self.agents}

    def agent_of(self, action: GroundAtom) -> Agent:
        """Who executes an action: its first argument if that is an agent, else the (first) robot."""
        try:
            return self._agent_by_name[action[1]]
        except (IndexError, KeyError):
            return self._first_robot

    @cached_property
    def _first_robot(self) -> Agent:
        return next(agent for agent in self.agents if agent.kind == "robot")


@dataclass(frozen=True, slots=True)
class TeamTask:
    """A grounded team problem: the composite task and the mental task."""

    problem: TeamProblem
    task: "Task"
    mental: "Task"


def agent_kind(domain: Domain, types: Iterable[str]) -> Literal["robot", "human"] | None:
    """Whether things of these types are robots, humans, or no agents at all."""
    return _kind(supertypes(domain, types))


def _kind(above: frozenset[str]) -> Literal["robot", "human"] | None:
    if "human" in above:
        return "human"
    return "robot" if "robot" in above else None


def agent_kinds(problem: Problem) -> dict[str, Literal["robot", "human"] | None]:
    """Say of each object, constants included, whether it is a robot, a human, or no agent at all.

    Examples
    --------
    >>> from explicable.model.problem import TRUE
    >>> domain = Domain("d", frozenset(), {"robot": ("object",)}, {}, (), (), ())
    >>> agent_kinds(Problem("p", domain, {"r": ("robot",), "door": ("object",)}, (), TRUE, {}))
    {'r': 'robot', 'door': None}
    """
    return {name: _kind(above) for name, above in object_types(problem).items()}


def find_undecided(problem: Problem) -> tuple[str, ...]:
    """List the objects that are robots and humans at once, so that nobody can say who acts.

    Examples
    --------
    >>> from explicable.model.problem import TRUE
    >>> domain = Domain("d", frozenset(), {"robot": ("object",), "human": ("object",)}, {}, (), (), ())
    >>> find_undecided(Problem("p", domain, {"r": ("robot",), "x": ("robot", "human")}, (), TRUE, {}))
    ('x',)
    """
    return tuple(name for name, above in object_types(problem).items() if {"robot", "human"} <= above)


def explain_undecided(name: str) -> str:
    """Say what is wrong with such an object."""
    return f"object {name!r} is both a robot and a human: an agent is either"


def schema_kind(domain: Domain, schema: ActionSchema) -> Literal["robot", "human"]:
    """Who owns an action schema, by the type of its first parameter; robots if it is open to both."""
    kinds = {agent_kind(domain, [name]) for parameter in schema.parameters[:1] for name in parameter.types}
    return "human" if kinds == {"human"} else "robot"


@dataclass(frozen=True, slots=True)
class Conflict:
    """A name that the two models use for different things, so that they can't be composed.

    Parameters
    ----------
    kind
        What is declared: ``"type"``, ``"object"``, ``"predicate"``, ``"function"`` or ``"action"``.
    name
        Its name.
    robot, human
        What each of the models says of it.
    """

    kind: str
    name: str
    robot: str
    human: str

    def __str__(self) -> str:
        return f"{self.kind} {self.name!r} {self.robot} in the robot's model, but {self.human} in the human's"


def find_conflicts(robot: Problem, human: Problem) -> tuple[Conflict, ...]:
    """List what keeps the two models from being composed.

    Types with other parents, objects of other types, predicates and functions of another arity, or over types
    that no object can have in both models, and actions that are robots' in one and humans' in the other.
    Anything else that differs is a difference of opinion, not a conflict.

    Examples
    --------
    >>> from explicable.model.problem import TRUE, Parameter
    >>> own = Domain("d", frozenset(), {}, {}, (Predicate("at", ()),), (), ())
    >>> theirs = replace(own, predicates=(Predicate("at", (Parameter("?p", ("object",)),)),))
    >>> problem = Problem("p", own, {}, (), TRUE, {})
    >>> print(*find_conflicts(problem, replace(problem, domain=theirs)))
    predicate 'at' takes () in the robot's model, but (object) in the human's
    """
    own, theirs = robot.domain, human.domain
    types = {**theirs.types, **own.types}
    above = ancestors(types)

    def overlap(one: Iterable[str], other: Iterable[str]) -> bool:
        return any(not kinds.isdisjoint(one) and not kinds.isdisjoint(other) for kinds in above.values())

    def clash(one: Predicate | Function, other: Predicate | Function) -> bool:
        return len(one.parameters) != len(other.parameters) or not all(
            overlap(p.types, q.types) for p, q in zip(one.parameters, other.parameters, strict=True)
        )

    conflicts = [
        *_differing("type", own.types, theirs.types, "is"),
        *_differing(
            "object", {**own.constants, **robot.objects}, {**theirs.constants, **human.objects}, "is"
        ),
    ]
    if conflicts:
        return tuple(conflicts)  # what follows may only follow from these
    declared: tuple[tuple[str, tuple[Predicate | Function, ...], tuple[Predicate | Function, ...]], ...] = (
        ("predicate", own.predicates, theirs.predicates),
        ("function", own.functions, theirs.functions),
    )
    for kind, mine, believed in declared:
        by_name = {one.name: one for one in believed}
        for one in mine:
            other = by_name.get(one.name)
            if other is not None and clash(one, other):
                conflicts.append(Conflict(kind, one.name, f"takes {_form(one)}", _form(other)))
    owners = {schema.name: schema_kind(theirs, schema) for schema in theirs.actions}
    for schema in own.actions:
        kind, other_kind = schema_kind(own, schema), owners.get(schema.name)
        if other_kind not in {None, kind}:
            conflicts.append(Conflict("action", schema.name, f"belongs to {kind}s", f"to {other_kind}s"))
    return tuple(conflicts)


def _differing(
    kind: str, own: Mapping[str, tuple[str, ...]], theirs: Mapping[str, tuple[str, ...]], verb: str
) -> Iterator[Conflict]:
    for name, mine in own.items():
        believed = theirs.get(name, mine)
        if set(mine) != set(believed):
            yield Conflict(kind, name, f"{verb} {format_types(mine)}", format_types(believed))


def _form(declared: Predicate | Function) -> str:
    return f"({' '.join(format_types(parameter.types) for parameter in declared.parameters)})"


def compose(robot: Problem, human: Problem) -> Problem:
    """Compose ``M_R`` and ``~M_H`` into one problem.

    Robots' action schemas, the initial state and the goal come from the robot's problem; humans' schemas from
    the human's problem if it has any. Facts of predicates that the robot does not know are taken from the
    human's initial state.

    Raises
    ------
    ConflictError
        If the two use a name for different things; see `find_conflicts`.
    """
    if conflicts := find_conflicts(robot, human):
        raise ConflictError([PDDLError(str(conflict)) for conflict in conflicts])
    own, theirs = robot.domain, human.domain
    human_schemas = [schema for schema in theirs.actions if schema_kind(theirs, schema) == "human"]
    robot_side = [a for a in own.actions if not human_schemas or schema_kind(own, a) == "robot"]
    known = {predicate.name for predicate in own.predicates}
    functions = {function.name for function in own.functions}
    constants = {**own.constants, **theirs.constants}
    objects = {**robot.objects, **human.objects}
    domain = replace(
        own,
        requirements=own.requirements | theirs.requirements,
        types={**own.types, **theirs.types},
        constants=constants,
        predicates=(*own.predicates, *(p for p in theirs.predicates if p.name not in known)),
        functions=(*own.functions, *(f for f in theirs.functions if f.name not in functions)),
        actions=(*robot_side, *human_schemas),
    )
    return replace(
        robot,
        domain=domain,
        objects={name: types for name, types in objects.items() if name not in constants},
        init=robot.init + tuple(atom for atom in human.init if atom[0] not in known),
        values={**human.values, **robot.values},
    )

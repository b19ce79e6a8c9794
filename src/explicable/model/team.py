"""Teams: who acts, and the composition of the robot's and the human's model into one problem."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, TypeVar

from explicable.errors import PDDLError
from explicable.model.problem import (
    ActionSchema,
    Domain,
    Function,
    GroundAtom,
    Predicate,
    Problem,
    supertypes,
)

if TYPE_CHECKING:
    from explicable.model.task import Task

DEFAULT_ROBOT = "robot"

Declared = TypeVar("Declared", Predicate, Function)
Value = TypeVar("Value")


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
        PDDLError
            If the two models declare the same name differently; the message gives the name.
        """
        return self.robot if self.human is None else compose(self.robot, self.human)

    @cached_property
    def agents(self) -> tuple[Agent, ...]:
        """The team's members in the order of declaration; a lone default robot where no object is a robot."""
        domain = self.composite.domain
        agents = []
        for name, types in {**domain.constants, **self.composite.objects}.items():
            kind = agent_kind(domain, types)
            if kind is not None:
                agents.append(Agent(name, kind))
        if not any(agent.kind == "robot" for agent in agents):
            agents.insert(0, Agent(DEFAULT_ROBOT, "robot"))
        return tuple(agents)

    @cached_property
    def _agent_by_name(self) -> dict[str, Agent]:
        return {agent.name: agent for agent in self.agents}

    def agent_of(self, action: GroundAtom) -> Agent:
        """Who executes an action: its first argument if that is an agent, else the (first) robot."""
        agent = self._agent_by_name.get(action[1]) if len(action) > 1 else None
        return agent or next(agent for agent in self.agents if agent.kind == "robot")


@dataclass(frozen=True, slots=True)
class TeamTask:
    """A grounded team problem: the composite task and the mental task."""

    problem: TeamProblem
    task: "Task"
    mental: "Task"


def agent_kind(domain: Domain, types: Iterable[str]) -> Literal["robot", "human"] | None:
    """Whether things of these types are robots, humans, or no agents at all."""
    above = supertypes(domain, types)
    if "human" in above:
        return "human"
    return "robot" if "robot" in above else None


def schema_kind(domain: Domain, schema: ActionSchema) -> Literal["robot", "human"]:
    """Who owns an action schema, by the type of its first parameter."""
    if schema.parameters and agent_kind(domain, schema.parameters[0].types) == "human":
        return "human"
    return "robot"


def compose(robot: Problem, human: Problem) -> Problem:
    """Compose ``M_R`` and ``~M_H`` into one problem.

    Robots' action schemas, the initial state and the goal come from the robot's problem; humans' schemas from
    the human's problem if it has any. Facts of predicates that the robot does not know are taken from the
    human's initial state.

    Raises
    ------
    PDDLError
        If a type, object, predicate or function is declared differently in the two; the message names it.
    """
    own, theirs = robot.domain, human.domain
    human_schemas = [schema for schema in theirs.actions if schema_kind(theirs, schema) == "human"]
    robot_side = [a for a in own.actions if not human_schemas or schema_kind(own, a) == "robot"]
    known = {predicate.name for predicate in own.predicates}
    domain = replace(
        own,
        requirements=own.requirements | theirs.requirements,
        types=_merge("type", own.types, theirs.types),
        constants=_merge("constant", own.constants, theirs.constants),
        predicates=_merge_declared("predicate", own.predicates, theirs.predicates),
        functions=_merge_declared("function", own.functions, theirs.functions),
        actions=(*robot_side, *human_schemas),
    )
    return replace(
        robot,
        domain=domain,
        objects=_merge("object", robot.objects, human.objects),
        init=robot.init + tuple(atom for atom in human.init if atom[0] not in known),
        values={**human.values, **robot.values},
    )


def _merge(kind: str, own: Mapping[str, Value], theirs: Mapping[str, Value]) -> Mapping[str, Value]:
    for name in own.keys() & theirs.keys():
        if own[name] != theirs[name]:
            raise PDDLError(f"{kind} {name!r} differs between the robot's and the human's model")
    return {**own, **theirs}


def _merge_declared(
    kind: str, own: tuple[Declared, ...], theirs: tuple[Declared, ...]
) -> tuple[Declared, ...]:
    by_name = {declared.name: declared for declared in own}
    for declared in theirs:
        other = by_name.get(declared.name)
        if other is not None and len(other.parameters) != len(declared.parameters):
            raise PDDLError(f"{kind} {declared.name!r} differs between the robot's and the human's model")
    return own + tuple(declared for declared in theirs if declared.name not in by_name)

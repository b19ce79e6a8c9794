"""What the labeller sees of a step: lifted features of plans, computed for a team task (docs/labelling.md).

No feature names an object, so that what is learned on one map holds on every other. None depends on absolute
position, on the plan's length, or on more than one step ahead, so that a search can score a plan step by
step; `cpp/labelling/scorer.cpp` holds the same definitions for that purpose.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

from explicable import _core
from explicable.errors import ResourceError
from explicable.labelling.templates import (
    MAX_ARGUMENTS,
    NOTHING,
    PROGRESS,
    TEMPLATES,
    FeatureCode,
    feature_code,
)
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request, find_requests
from explicable.model.task import State
from explicable.model.team import TeamTask, agent_kinds

MAX_REQUESTS = 8
"""A person keeps so many open requests in mind; older ones are forgotten."""

RECENT_STEPS = 4
"""So many of the robots' latest steps can be taken back by a later one."""


class TeamFeatures:
    """Features of the steps of one team task.

    Making it measures the distance of every fact to every goal and request: keep it for all plans of a task.

    Parameters
    ----------
    team
        A grounded team problem.

    Raises
    ------
    ResourceError
        If the task has too many facts, goals and requests to keep all distances.
    """

    def __init__(self, team: TeamTask) -> None:
        self.team = team
        self.task = team.task
        self.schemas = tuple(action.name for action in team.task.problem.domain.actions)
        self.tables = _make_tables(team)
        self._goal = team.task.goal
        self._request_facts = self.tables.request_facts

    @cached_property
    def requests(self) -> dict[GroundAtom, Request]:
        """What each human step asks for, by the step."""
        return find_requests(self.team.problem, self.task)

    def codes(self, features: tuple[str, ...]) -> tuple[FeatureCode | None, ...]:
        """Return what `feature_code` does for each feature and the schemas of this task."""
        return _codes(features, self.schemas, self.tables.max_arity)

    @cached_property
    def choices(self) -> _core.HumanChoices:
        """What the person can do in a state, with the features of each choice."""
        team = self.team
        return _core.HumanChoices(team.task.core, team.mental.core, self.tables, *_mental_names(team))

    def extract(
        self,
        operators: Sequence[int],
        states: Sequence[State],
        knowing: "Sequence[TeamFeatures] | None" = None,
    ) -> list[tuple[str, ...]]:
        """Return the features of each step; human steps have none, since nobody is asked about them.

        Parameters
        ----------
        operators
            The plan. Steps beyond the last state are the tail of a relaxed plan: they are not executed, so
            that goals and requests stay as they are in the last state, but for what the tail itself fulfils
            and asks.
        states
            The state before each executed step, and the state after the last one.
        knowing
            For each step, the same task with the mental model that the person has by then. Default: this one.
        """
        walk = _Walk()
        steps: list[_SeenStep] = []
        fulfilled: list[bool] = []
        for number, operator in enumerate(operators):
            if number < len(states):
                fulfilled = [self.task.core.holds(states[number], [fact]) for fact in self._goal]
            watching = knowing[number] if knowing else self
            steps.append(watching._see(walk, operator, fulfilled))
            walk.remember(self.tables, steps[-1])
            if number + 1 < len(states):
                walk.requests = [r for r in walk.requests if self.stands(r, states[number + 1])]
            for goal in self.tables.achieves(operator):
                fulfilled[goal] = True
        following: list[_SeenStep | None] = [*steps[1:], None]
        return [
            () if step.is_human else (*step.features, *_look_ahead(step, after))
            for step, after in zip(steps, following, strict=False)
        ]

    def stands(self, request: int, state: State) -> bool:
        """Whether a request, by its number, has not been withdrawn."""
        return any(self.task.core.holds(state, [fact]) for fact in self._request_facts[request])

    def _see(self, walk: "_Walk", operator: int, fulfilled: list[bool]) -> "_SeenStep":
        schema, *arguments = self.task.action(operator)
        step = _SeenStep(operator, schema, tuple(arguments), self.tables.is_human(operator))
        if not step.is_human:
            step.features = tuple(self._features(walk, step, fulfilled))
        return step

    def _features(self, walk: "_Walk", step: "_SeenStep", fulfilled: list[bool]) -> Iterator[str]:
        schema, last = step.schema, walk.last
        yield _name("step", schema)
        yield _name("after", schema, last.schema if last else NOTHING)
        yield from _equalities("same-after", step, last)
        yield from _equalities("same-human", step, walk.last_human)
        taken_back = [self.tables.takes_back(step.operator, earlier) for earlier in walk.robot_steps]
        if any(taken_back):
            yield _name("undoes" if taken_back[0] else "returns", schema)
        if not self.tables.is_believed(step.operator):
            yield _name("unbelieved", schema)

        request = walk.requests[-1] if walk.requests else -1
        mental, own = (PROGRESS[p] for p in self.tables.toward_request(step.operator, request))
        if mental != "done" and not set(self.tables.fulfils(step.operator)).isdisjoint(walk.requests):
            mental = own = "done-other"
        goal, goal_own, mission = (PROGRESS[p] for p in self.tables.toward_goals(step.operator, fulfilled))
        yield _name("request", schema, mental)
        yield _name("request-own", schema, own)
        yield _name("goal", schema, goal)
        yield _name("goal-own", schema, goal_own)
        yield _name("mission", schema, mission)
        yield _name("models", mental, own)
        yield _name("request-mission", mental, mission)
        yield _name("trend", mental, last.seen_as if last else NOTHING)
        step.seen_as = mental


@dataclass(slots=True)
class _SeenStep:
    operator: int
    schema: str
    arguments: tuple[str, ...]
    is_human: bool
    features: tuple[str, ...] = ()
    seen_as: str = "human-step"  # by the steps beside it


@dataclass(slots=True)
class _Walk:
    """What the features of the next step need of the steps before it."""

    last: _SeenStep | None = None
    last_human: _SeenStep | None = None
    requests: list[int] = field(default_factory=list)  # open ones, the latest last
    robot_steps: list[int] = field(default_factory=list)  # recent ones, the latest first

    def remember(self, tables: _core.TeamTables, step: _SeenStep) -> None:
        self.last = step
        if not step.is_human:
            self.robot_steps = [step.operator, *self.robot_steps][:RECENT_STEPS]
            done = tables.fulfils(step.operator)
            self.requests = [request for request in self.requests if request not in done]
            return
        self.last_human = step
        asked = tables.asks_for(step.operator)
        if asked >= 0:
            others = (request for request in self.requests if request != asked)
            self.requests = [*others, asked][-MAX_REQUESTS:]


@lru_cache(maxsize=16)  # the same for all tasks of a domain
def _codes(
    features: tuple[str, ...], schemas: tuple[str, ...], max_arity: int
) -> tuple[FeatureCode | None, ...]:
    numbers = {name: number for number, name in enumerate(schemas)}
    return tuple(feature_code(feature, numbers, max_arity) for feature in features)


@lru_cache(maxsize=10_000)  # names are few, and asked for at every step
def _name(template: str, *values: str | int) -> str:
    return TEMPLATES[template].feature(*values)


def _equalities(template: str, step: _SeenStep, other: _SeenStep | None) -> Iterator[str]:
    if other is None:
        return
    for i, mine in enumerate(step.arguments[:MAX_ARGUMENTS], start=1):
        for j, theirs in enumerate(other.arguments[:MAX_ARGUMENTS], start=1):
            if mine == theirs:
                yield _name(template, step.schema, other.schema, i, j)


def _look_ahead(step: _SeenStep, after: _SeenStep | None) -> Iterator[str]:
    yield _name("before", step.schema, after.schema if after else NOTHING)
    yield from _equalities("same-before", step, after)
    yield _name("outlook", step.seen_as, after.seen_as if after else NOTHING)


def _make_tables(team: TeamTask) -> _core.TeamTables:
    kinds = agent_kinds(team.task.problem)
    try:
        return _core.TeamTables(
            team.task.core,
            team.mental.core,
            list(team.task.goal),
            *_mental_names(team),
            [kinds[name] == "human" for name in team.task.objects],
        )
    except ValueError as error:  # std::length_error
        raise ResourceError(f"problem {team.task.problem.name}: {error}") from error


def _mental_names(team: TeamTask) -> tuple[list[int], list[int], list[int]]:
    """Return the mental task's numbers of schemas, predicates and objects; -1 where it has none such."""
    own, mental = team.task.problem.domain, team.mental.problem.domain
    return (
        _translation([a.name for a in own.actions], [a.name for a in mental.actions]),
        _translation([p.name for p in own.predicates], [p.name for p in mental.predicates]),
        _translation(team.task.objects, team.mental.objects),
    )


def _translation(names: Sequence[str], theirs: Sequence[str]) -> list[int]:
    numbers = {name: number for number, name in enumerate(theirs)}
    return [numbers.get(name, -1) for name in names]

"""Joint plans whose steps overlap: from a sequence to a partial order with start times.

A sequential plan says more than it must about who goes first. Its *deordering* keeps, of ``i`` before ``j``,
only

1. the causal links: each precondition of ``j`` has one producer, of those with no deleter in between the one
   that is done soonest, or none if it has been true since the start;
2. the threats: a step that deletes a fact stays on its side of each step that needs it;
3. the last word: of two steps, one adding and one deleting the same fact, the order stays, so that every
   order ends in the same state, not only in a goal state;
4. conditional effects: a step stays on its side of whatever writes a fact that they look at;
5. one step at a time for each agent.

The first two are explanation-based order generalisation (Kambhampati & Kedar, "A unified framework for
explanation-based generalization of partially ordered and partially instantiated plans", Artificial
Intelligence 67, 1994; validity and limits in Bäckström, "Computational aspects of reordering plans", JAIR 9,
1998). Every linearisation is then executable and ends where the sequence ends. Two steps with no path between
them don't interfere: neither deletes what the other needs or adds. So they may overlap in time, whenever
within their duration they read and write: preconditions hold from start to end.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from explicable.model.durations import Durations
from explicable.model.plan import Step, format_action
from explicable.model.problem import GroundAtom
from explicable.model.task import State, Task
from explicable.model.team import TeamProblem


@dataclass(frozen=True, slots=True)
class ScheduledStep:
    """A step in a schedule.

    Parameters
    ----------
    step
        Who does what.
    start, duration
        In the unit of the durations.
    after
        Numbers of the steps that must have ended before this one starts, without those that others imply.
    """

    step: Step
    start: float
    duration: float
    after: tuple[int, ...]

    @property
    def end(self) -> float:
        """When it is done."""
        return self.start + self.duration


@dataclass(frozen=True, slots=True)
class Schedule:
    """A joint plan as a partial order with earliest start times.

    Parameters
    ----------
    steps
        By start time; of several that start together, as in the plan it came from. This order is one of the
        linearisations, and the one whose labels count as those of the schedule.
    makespan
        When the last step is done.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground
    >>> team = encode(World(("@.*", "@..")))
    >>> moves = [("move", "r1", "c-0-0", "c-0-1"), ("move", "r2", "c-1-0", "c-1-1")]
    >>> both = make_schedule(team, ground(team.composite), moves)
    >>> both.makespan, [scheduled.start for scheduled in both.steps]
    (1.0, [0.0, 0.0])
    """

    steps: tuple[ScheduledStep, ...]
    makespan: float

    @property
    def actions(self) -> tuple[GroundAtom, ...]:
        """The actions by start time."""
        return tuple(scheduled.step.action for scheduled in self.steps)

    @property
    def agents(self) -> tuple[str, ...]:
        """Who acts, in the order of their first steps."""
        return tuple(dict.fromkeys(scheduled.step.agent for scheduled in self.steps))

    @property
    def critical_path(self) -> tuple[int, ...]:
        """Numbers of steps that follow each other without a pause from time 0 to the makespan."""
        path: list[int] = []
        last = max(range(len(self.steps)), key=lambda number: self.steps[number].end, default=None)
        while last is not None:
            path.append(last)
            last = max(self.steps[last].after, key=lambda number: self.steps[number].end, default=None)
        return tuple(reversed(path))

    def linearisations(self) -> Iterator[tuple[GroundAtom, ...]]:
        """Give every order that keeps the partial order; there can be very many."""
        yield from self._extend((), frozenset())

    def _extend(self, done: tuple[int, ...], known: frozenset[int]) -> Iterator[tuple[GroundAtom, ...]]:
        if len(done) == len(self.steps):
            yield tuple(self.steps[number].step.action for number in done)
        for number, scheduled in enumerate(self.steps):
            if number not in known and known.issuperset(scheduled.after):
                yield from self._extend((*done, number), known | {number})


def make_schedule(
    problem: TeamProblem,
    task: Task,
    actions: Sequence[GroundAtom],
    durations: Durations | None = None,
    state: State | None = None,
) -> Schedule:
    """Deorder a sequential plan and start every step as soon as it can.

    Parameters
    ----------
    problem
        Says who acts.
    task
        The composite task.
    actions
        A sequence that the task allows.
    durations
        By default 1 each.
    state
        Where it begins; by default the initial state.

    Raises
    ------
    PlanError
        At the first step that is not applicable.
    """
    durations = durations or Durations()
    execution = task.execute(actions, state)
    steps = [Step(problem.agent_of(action).name, action) for action in actions]
    order = _Deordering(task.core.true_facts(execution.states[0]))
    starts: list[float] = []
    ends: list[float] = []
    after: list[set[int]] = []
    for number, (operator, step) in enumerate(zip(execution.operators, steps, strict=True)):
        use = fact_use(task, execution.states[number], operator)
        before = order.take(number, use, step.agent, ends)
        starts.append(max((ends[other] for other in before), default=0.0))
        ends.append(starts[-1] + durations.of(step.action))
        after.append(before)
    by_start = sorted(range(len(steps)), key=lambda number: (starts[number], number))
    place = {number: rank for rank, number in enumerate(by_start)}
    reduced = _without_shortcuts([{place[other] for other in after[number]} for number in by_start])
    return Schedule(
        tuple(
            ScheduledStep(
                steps[number], starts[number], ends[number] - starts[number], reduced[place[number]]
            )
            for number in by_start
        ),
        max(ends, default=0.0),
    )


def format_schedule(schedule: Schedule) -> str:
    """Write a schedule as the planning competitions write temporal plans: start, action, duration.

    Examples
    --------
    >>> step = ScheduledStep(Step("r1", ("move", "r1", "a", "b")), 0.0, 1.5, ())
    >>> print(format_schedule(Schedule((step,), 1.5)), end="")
    0.000: (move r1 a b) [1.500]
    ; makespan = 1.5
    """
    lines = [
        f"{scheduled.start:.3f}: {format_action(scheduled.step.action)} [{scheduled.duration:.3f}]\n"
        for scheduled in schedule.steps
    ]
    return "".join(lines) + f"; makespan = {schedule.makespan:g}\n"


class _Deordering:
    """For each fact, who has used it so far; steps by number."""

    def __init__(self, initial: Iterable[int]) -> None:
        self.since_start = set(initial)  # true, and never deleted
        self.producers: defaultdict[int, list[int]] = defaultdict(list)  # since it was last deleted
        self.readers: defaultdict[int, list[int]] = defaultdict(list)
        self.watchers: defaultdict[int, list[int]] = defaultdict(list)  # by conditional effects
        self.adders: defaultdict[int, list[int]] = defaultdict(list)
        self.deleters: defaultdict[int, list[int]] = defaultdict(list)
        self.agents: dict[str, int] = {}

    def take(self, number: int, use: "FactUse", agent: str, ends: Sequence[float]) -> set[int]:
        """Append a step; return the steps that must be done before it."""
        before = {self.agents[agent]} if agent in self.agents else set()
        for fact in use.needs - self.since_start:
            before.add(min(self.producers[fact], key=lambda producer: ends[producer]))
        for fact in use.looks_at:
            before.update(self.adders[fact], self.deleters[fact])
        for fact in use.adds:
            before.update(self.deleters[fact], self.watchers[fact])
        for fact in use.deletes:
            before.update(self.adders[fact], self.readers[fact], self.watchers[fact])
        self._note(number, use)
        self.agents[agent] = number
        return before

    def _note(self, number: int, use: "FactUse") -> None:
        for fact in use.needs:
            self.readers[fact].append(number)
        for fact in use.looks_at:
            self.watchers[fact].append(number)
        for fact in use.deletes:
            self.deleters[fact].append(number)
            self.producers[fact] = []
            self.since_start.discard(fact)
        for fact in use.adds:
            self.adders[fact].append(number)
            self.producers[fact].append(number)


@dataclass(frozen=True, slots=True)
class FactUse:
    """What an operator does with facts in a state.

    Parameters
    ----------
    needs
        Preconditions.
    looks_at
        Conditions of conditional effects, of those that fire and of those that don't.
    adds, deletes
        Facts that it makes true or false; of both, the add prevails.
    """

    needs: frozenset[int]
    looks_at: frozenset[int]
    adds: frozenset[int]
    deletes: frozenset[int]


def fact_use(task: Task, state: State, operator: int) -> FactUse:
    """Return what an operator does with facts in a state."""
    core = task.core
    adds, deletes = set(core.adds(operator)), set(core.deletes(operator))
    looks_at: set[int] = set()
    for condition, more_adds, more_deletes in core.effects(operator):
        looks_at.update(condition)
        if core.holds(state, condition):
            adds.update(more_adds)
            deletes.update(more_deletes)
    return FactUse(
        frozenset(core.preconditions(operator)),
        frozenset(looks_at),
        frozenset(adds),
        frozenset(deletes - adds),
    )


def _without_shortcuts(after: Sequence[set[int]]) -> list[tuple[int, ...]]:
    """Leave out what follows from the rest; each step comes later than those that it is after."""
    reachable: list[int] = []  # bit sets
    reduced = []
    for before in after:
        beyond = 0
        for other in before:
            beyond |= reachable[other]
        reduced.append(tuple(other for other in sorted(before) if not beyond >> other & 1))
        reachable.append(beyond | sum(1 << other for other in before))
    return reduced

"""Joint plans whose steps overlap: from a sequence to a partial order with start times.

A sequential plan says more than it must about who goes first. Its *deordering* keeps, of ``i`` before ``j``,
only

1. the causal links: each precondition of ``j`` has one producer, of those with no deleter in between the one
   that is done soonest, or none if it has been true since the start;
2. the threats: a step that deletes a fact stays on its side of each step that needs it;
3. the last word: of two steps, one adding and one deleting the same fact, the order stays, so that every
   order ends in the same state, not only in a goal state;
4. conditional effects: a step stays on its side of whatever writes a fact that they look at;
5. one step at a time for each agent;
6. who is told something knows it from then on: whatever follows the telling in the plan waits for its end.

The first two are explanation-based order generalisation (Kambhampati & Kedar, "A unified framework for
explanation-based generalization of partially ordered and partially instantiated plans", Artificial
Intelligence 67, 1994; validity and limits in Bäckström, "Computational aspects of reordering plans", JAIR 9,
1998). Every linearisation is then executable and ends where the sequence ends. Two steps with no path between
them don't interfere: neither deletes what the other needs or adds. So they may overlap in time, whenever
within their duration they read and write: preconditions hold from start to end.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

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
    listeners
        The people who are told something by it, and do nothing else meanwhile; empty for an action.
    """

    step: Step
    start: float
    duration: float
    after: tuple[int, ...]
    listeners: tuple[str, ...] = ()

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
        """The actions by start time; to tell something is none."""
        return tuple(scheduled.step.action for scheduled in self.steps if not scheduled.listeners)

    @property
    def agents(self) -> tuple[str, ...]:
        """Who acts or listens, in the order of their first steps."""
        busy = (name for scheduled in self.steps for name in (scheduled.step.agent, *scheduled.listeners))
        return tuple(dict.fromkeys(busy))

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
        """Give every order of the actions that keeps the partial order; there can be very many."""
        yield from self._extend((), frozenset())

    def _extend(self, done: tuple[int, ...], known: frozenset[int]) -> Iterator[tuple[GroundAtom, ...]]:
        if len(done) == len(self.steps):
            yield tuple(self.steps[number].step.action for number in done if not self.steps[number].listeners)
        for number, scheduled in enumerate(self.steps):
            if number not in known and known.issuperset(scheduled.after):
                yield from self._extend((*done, number), known | {number})


def make_schedule(
    problem: TeamProblem,
    task: Task,
    actions: Sequence[GroundAtom],
    durations: Durations | None = None,
    state: State | None = None,
    *,
    tellings: Sequence[tuple[int, Step]] = (),
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
    tellings
        Steps by which an agent tells all people something, in order, each with the number of the action
        before which it comes. They occupy who tells and who listens.

    Raises
    ------
    PlanError
        At the first step that is not applicable.
    """
    durations = durations or Durations()
    execution = task.execute(actions, state)
    people = tuple(agent.name for agent in problem.agents if agent.kind == "human") if tellings else ()
    order = _Deordering(task.core.true_facts(execution.states[0]), durations)
    pending = list(tellings)
    for number, (operator, action) in enumerate(zip(execution.operators, actions, strict=True)):
        while pending and pending[0][0] <= number:
            order.tell(pending.pop(0)[1], people)
        use = fact_use(task, execution.states[number], operator)
        order.act(Step(problem.agent_of(action).name, action), use)
    for _, telling in pending:
        order.tell(telling, people)
    return order.schedule()


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
    """The steps so far, each as early as it can start, and for each fact who has used it; by number."""

    def __init__(self, initial: Iterable[int], durations: Durations) -> None:
        self.durations = durations
        self.steps: list[ScheduledStep] = []
        self.after: list[set[int]] = []
        self.since_start = set(initial)  # true, and never deleted
        self.producers: defaultdict[int, list[int]] = defaultdict(list)  # since it was last deleted
        self.readers: defaultdict[int, list[int]] = defaultdict(list)
        self.watchers: defaultdict[int, list[int]] = defaultdict(list)  # by conditional effects
        self.adders: defaultdict[int, list[int]] = defaultdict(list)
        self.deleters: defaultdict[int, list[int]] = defaultdict(list)
        self.agents: dict[str, int] = {}
        self.last_telling: set[int] = set()

    def act(self, step: Step, use: "FactUse") -> None:
        """Append an action."""
        before = set[int]()
        for fact in use.needs - self.since_start:
            before.add(min(self.producers[fact], key=lambda producer: self.steps[producer].end))
        for fact in use.looks_at:
            before.update(self.adders[fact], self.deleters[fact])
        for fact in use.adds:
            before.update(self.deleters[fact], self.watchers[fact])
        for fact in use.deletes:
            before.update(self.adders[fact], self.readers[fact], self.watchers[fact])
        self._note(len(self.steps), use)
        self._append(step, before)

    def tell(self, step: Step, listeners: tuple[str, ...]) -> None:
        """Append a step that tells people something."""
        self._append(step, set(), listeners)
        self.last_telling = {len(self.steps) - 1}

    def schedule(self) -> Schedule:
        """Give the steps by start time."""
        by_start = sorted(range(len(self.steps)), key=lambda number: (self.steps[number].start, number))
        place = {number: rank for rank, number in enumerate(by_start)}
        reduced = _without_shortcuts([{place[other] for other in self.after[number]} for number in by_start])
        steps = (
            replace(self.steps[number], after=after) for number, after in zip(by_start, reduced, strict=True)
        )
        return Schedule(tuple(steps), max((step.end for step in self.steps), default=0.0))

    def _append(self, step: Step, before: set[int], listeners: tuple[str, ...] = ()) -> None:
        busy = (step.agent, *listeners)
        before |= self.last_telling | {self.agents[name] for name in busy if name in self.agents}
        start = max((self.steps[other].end for other in before), default=0.0)
        self.agents |= dict.fromkeys(busy, len(self.steps))
        self.after.append(before)
        self.steps.append(ScheduledStep(step, start, self.durations.of(step.action), (), listeners))

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

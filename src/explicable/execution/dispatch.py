"""Carrying a schedule out: several robots and people at once, each by the protocol for robots.

A step is sent as soon as those before it in the partial order are done and its agent is free, whatever the
clock says: a late or failed step delays its successors, and nothing else. When what is left no longer leads
to the goal, nothing new is sent, what is under way is waited for, and the rest is planned anew from there.
"""

import time
from collections import Counter, defaultdict, deque
from collections.abc import Callable, Iterable

from explicable.errors import UsageError
from explicable.execution import mind as minds
from explicable.execution.dispatch_run import Dispatched, DispatchLimits, DispatchRun
from explicable.execution.episodes import Ending
from explicable.execution.facts import change_state, most_specific, restart_at
from explicable.execution.mind import Mind
from explicable.execution.robots.door import Door
from explicable.execution.robots.protocol import (
    Blocked,
    Fact,
    Failed,
    Finished,
    Observation,
    Order,
    Refused,
    Report,
    Robot,
    facts_of,
)
from explicable.execution.setting import Setting
from explicable.model.plan import Step
from explicable.model.problem import GroundAtom
from explicable.model.schedule import Schedule
from explicable.model.team import TeamProblem

_PAUSE_S = 0.01

Replan = Callable[[TeamProblem], Schedule | None]
"""Plans anew for a team problem that begins now; None if it knows no way."""


class Dispatcher:
    """Carries a schedule out; `run` does it all.

    Parameters
    ----------
    setting
        Where it happens; facts that may turn out to be otherwise must have been prepared for.
    schedule
        What to do.
    crew
        One robot of the protocol for each agent of the team who acts; a person's is whatever shows people
        their steps and says when they are done. What they report is checked.
    replan
        Plans the rest anew; by default nobody does.
    limits
        How long to wait for what.
    clock, pause
        Time in seconds, and how to let some of it pass.

    Raises
    ------
    UsageError
        If an agent has no robot, or two.
    """

    def __init__(
        self,
        setting: Setting,
        schedule: Schedule,
        crew: Iterable[Robot],
        *,
        replan: Replan = lambda _: None,
        limits: DispatchLimits | None = None,
        clock: Callable[[], float] = time.monotonic,
        pause: Callable[[float], object] = time.sleep,
    ) -> None:
        members = list(crew)
        self._crew = {member.name: Door(member, setting.truth.task) for member in members}
        missing = set(schedule.agents) - set(self._crew)
        if missing or len(self._crew) < len(members):
            wrong = ", ".join(sorted(missing)) or "two of a name"
            raise UsageError(f"each agent needs one robot; wrong for {wrong}")
        self._setting, self._truth = setting, setting.truth
        self._limits = limits or DispatchLimits()
        self._replan, self._clock, self._pause = replan, clock, pause
        self._state = setting.truth.task.initial_state
        self._mind = Mind(setting.belief.task.initial_state)
        self._outside: deque[GroundAtom] = deque()
        self._history: list[Dispatched] = []
        self._lost: set[str] = set()
        # Steps of lost agents; no new plan is made while there are any.
        self._given_up: dict[str, tuple[int, tuple[Order, float]]] = {}
        self._num_orders = self._num_plans = 0
        self._waiting_since: dict[str, float] = {}  # for agents that refuse
        self._seen: defaultdict[str, list[Fact]] = defaultdict(list)
        self._began = clock()
        self._adopt(schedule)

    def notify(self, action: GroundAtom) -> None:
        """Say, from any thread, that a person has done something that nobody had asked for."""
        self._outside.append(action)

    def run(self) -> DispatchRun:
        """Carry the schedule out to its end; after a Ctrl-C, what is under way is asked to stop."""
        ending = None
        try:
            while ending is None:
                ending = self._go_on()
        finally:
            if self._open:
                for member in self._crew.values():
                    member.cancel()
        return DispatchRun(ending, tuple(self._history), self._num_plans, frozenset(self._lost))

    def _go_on(self) -> Ending | None:
        happened = self._take_outside() | self._take_reports() | self._watch_the_clock()
        if self._is_outdated:
            self._waiting_since.clear()
        else:
            happened |= self._send_what_is_ready()
        if not self._open and not set(self._waiting_since) - self._lost:
            return self._conclude()
        if self._is_time_up():
            return Ending.TIME
        if not happened:
            self._pause(_PAUSE_S)
        return None

    def _adopt(self, schedule: Schedule) -> None:
        self._schedule = schedule
        self._done: set[int] = set()
        self._open: dict[int, tuple[Order, float]] = {}  # by number of the step; with the time of sending
        self._cancelled: set[int] = set()  # numbers of orders
        self._failures: Counter[int] = Counter()
        self._waiting_since.clear()
        self._is_outdated = False

    def _now(self) -> float:
        return self._clock() - self._began

    def _is_time_up(self) -> bool:
        return self._now() > self._limits.total_s

    def _conclude(self) -> Ending | None:
        """End, or plan anew, now that nothing is under way and nothing can be sent."""
        if self._truth.task.is_goal(self._state):
            return Ending.REACHED
        if self._lost or self._num_plans >= self._limits.max_plans:
            return Ending.STUCK
        if self._is_time_up():
            return Ending.TIME
        self._num_plans += 1
        problem = restart_at(
            self._setting.problem,
            self._truth.stage,
            self._state,
            self._setting.belief.stage,
            self._mind.state,
        )
        schedule = self._replan(problem)
        if schedule is None:
            return Ending.IMPOSSIBLE
        if not self._leads_to_goal(schedule.actions) or set(schedule.agents) - set(self._crew):
            return Ending.STUCK
        self._adopt(schedule)
        return None

    def _leads_to_goal(self, actions: Iterable[GroundAtom]) -> bool:
        state = self._truth.follow(self._state, actions)
        return state is not None and self._truth.task.is_goal(state)

    def _check_rest(self) -> None:
        steps = enumerate(self._schedule.steps)
        rest = [scheduled.step.action for number, scheduled in steps if number not in self._done]
        self._is_outdated = self._is_outdated or not self._leads_to_goal(rest)

    def _send_what_is_ready(self) -> bool:
        busy = {self._schedule.steps[number].step.agent for number in self._open} | self._lost
        sent = False
        for number, scheduled in enumerate(self._schedule.steps):
            step = scheduled.step
            waits = number in self._done or number in self._open or not self._done.issuperset(scheduled.after)
            if waits or step.agent in busy:
                continue
            if self._truth.operator(self._state, step.action) is None:
                self._is_outdated = True
                break
            sent |= self._send(number, step)
            busy.add(step.agent)
        return sent

    def _send(self, number: int, step: Step) -> bool:
        self._num_orders += 1
        order = Order(self._num_orders, step.action)
        if isinstance(self._crew[step.agent].send(order), Refused):
            # It may be out of reach for a moment: it is tried again, until it is given up for lost.
            first = self._waiting_since.setdefault(step.agent, self._now())
            if self._now() - first > 2 * self._limits.step_s:
                self._lost.add(step.agent)
            return False
        self._waiting_since.pop(step.agent, None)
        self._open[number] = (order, self._now())
        return True

    def _take_reports(self) -> bool:
        happened = False
        for name, member in self._crew.items():
            report = member.poll()
            if report is not None:
                happened = True
                self._take(name, report)
        return happened

    def _take(self, name: str, report: Report) -> None:
        if name in self._given_up and not isinstance(report, Observation):
            late, entry = self._given_up.pop(name)  # it was not lost after all
            self._open[late] = entry
            self._lost.discard(name)
        number = next((n for n in self._open if self._schedule.steps[n].step.agent == name), None)
        if isinstance(report, Observation) or number is None:
            # What a robot sees of things in motion counts when its step is over; of what is fixed, at once.
            self._seen[name] += [
                fact for fact in facts_of(report) if fact.atom not in self._truth.stage.beliefs
            ]
            self._learn(fact for fact in facts_of(report) if fact.atom in self._truth.stage.beliefs)
            if number is None:
                self._learn(self._seen.pop(name, []))
            return
        step, (order, sent_s) = self._schedule.steps[number].step, self._open.pop(number)
        self._cancelled.discard(order.number)
        self._history.append(Dispatched(step, sent_s, self._now(), report))
        if isinstance(report, Finished):
            self._done.add(number)
            self._is_outdated |= not self._happen(step.action)
        is_news = self._learn((*self._seen.pop(name, []), *facts_of(report)))
        if isinstance(report, Failed) or (isinstance(report, Blocked) and not is_news):
            self._fail(number, step)

    def _happen(self, action: GroundAtom) -> bool:
        """Let a step come true; False if, as far as is known, it can't have."""
        operator = self._truth.operator(self._state, action)
        if operator is None:
            return False
        after = self._truth.task.successor(self._state, operator)
        self._mind = minds.watch(self._setting, self._mind, action, self._state, after)
        self._state = after
        return True

    def _learn(self, facts: Iterable[Fact]) -> bool:
        """Take facts for true; whether that is news."""
        try:
            state = change_state(self._truth.stage, self._state, tuple(facts))
        except UsageError:
            return False  # there is no such state: the robot errs
        is_news = state != self._state
        self._state = state
        if is_news:
            self._check_rest()
        return is_news

    def _fail(self, number: int, step: Step) -> None:
        """Let a failed step be tried again, until its failing says something about the world."""
        self._failures[number] += 1
        if self._failures[number] >= self._limits.attempts:
            fact = most_specific(self._truth.stage, step.action)
            self._learn([fact] if fact else [])
            self._is_outdated = True

    def _take_outside(self) -> bool:
        happened = False
        while self._outside:
            action = self._outside.popleft()
            agent = self._setting.problem.agent_of(action)
            if agent.kind != "human" or not self._happen(action):
                continue
            happened = True
            self._history.append(Dispatched(Step(agent.name, action), self._now(), self._now(), None))
            early = [
                number
                for number, scheduled in enumerate(self._schedule.steps)
                if scheduled.step.action == action and number not in self._done and number not in self._open
            ]
            self._done.update(early[:1])
            self._check_rest()
        return happened

    def _watch_the_clock(self) -> bool:
        happened = False
        for number, (order, sent_s) in list(self._open.items()):
            agent, waited_s = self._schedule.steps[number].step.agent, self._now() - sent_s
            if waited_s > self._limits.step_s and order.number not in self._cancelled:
                self._cancelled.add(order.number)
                self._crew[agent].cancel()
                happened = True
            if waited_s > 2 * self._limits.step_s:
                self._lost.add(agent)
                self._given_up[agent] = number, self._open.pop(number)
                step = self._schedule.steps[number].step
                self._history.append(Dispatched(step, sent_s, self._now(), None))
                happened = True
        return happened

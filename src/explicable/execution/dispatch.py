"""Carrying a schedule out: several robots and people at once, each by the protocol for robots.

A step is sent as soon as those before it in the partial order are done and its agent is free, whatever the
clock says: a late or failed step delays its successors, and nothing else. When what is left no longer leads
to the goal, nothing new is sent, what is under way is waited for, and the rest is planned anew from there.
When an agent is lost, the others finish what does not depend on it; then the rest is planned without it.

What follows from each event is the `Course`'s to say, as in the closed loop: so all that happens is on
record, and can be replayed.
"""

import time
from collections import defaultdict, deque
from collections.abc import Callable, Iterable

from explicable.errors import UsageError
from explicable.execution.course import Course
from explicable.execution.dispatch_run import Dispatched, DispatchLimits, DispatchRun
from explicable.execution.episodes import Ending
from explicable.execution.facts import most_specific
from explicable.execution.monitor import FINAL, Event
from explicable.execution.notices import Notice
from explicable.execution.progress import Progress, Sent
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
from explicable.execution.runs import Run
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
            raise UsageError(
                f"each agent needs one robot: {', '.join(sorted(missing)) or 'a name is used twice'}"
            )
        if any(step.listeners for step in schedule.steps):
            raise UsageError(
                "a schedule that tells people something can't be sent: robots have no order for it"
            )
        self.course = Course(setting, at_once=True)
        self._truth, self._setting, self._replan = setting.truth, setting, replan
        self._limits, self._clock, self._pause = limits or DispatchLimits(), clock, pause
        self._outside: deque[GroundAtom] = deque()
        self._history: list[Dispatched] = []
        self._given_up: dict[str, Sent] = {}  # by lost agents
        self._num_orders = self._num_plans = 0
        self._planning_s: list[float] = []
        self._waiting_since: dict[str, float] = {}  # for agents that refuse
        self._seen: defaultdict[str, list[Fact]] = defaultdict(list)
        self._began = clock()
        self._bring(Notice(Event.PLAN_OUTDATED))
        self._adopt(schedule)

    def notify(self, action: GroundAtom) -> None:
        """Say, from any thread, that a person has done something that nobody had asked for."""
        self._outside.append(action)

    def run(self) -> DispatchRun:
        """Carry the schedule out to its end; after a Ctrl-C, what is under way is asked to stop."""
        try:
            while self.course.monitor not in FINAL:
                self._go_on()
        except KeyboardInterrupt:
            if self.course.monitor not in FINAL:
                self._bring(Notice(Event.ABORT))
            raise
        finally:
            if self._progress.under_way:
                for member in self._crew.values():
                    member.cancel()
        return self.result()

    def result(self) -> DispatchRun:
        """Return how it went, once it has ended."""
        played = Run.of(self.course, "nobody", "simulated", self._planning_s)
        return DispatchRun(
            played.episode.ending, tuple(self._history), self._num_plans, self.course.lost, played
        )

    def _bring(self, notice: Notice) -> bool:
        """Bring an event to the course; whether it was taken."""
        self.course.apply(notice, self._now())
        return not self.course.occurrences[-1].refusal

    def _go_on(self) -> None:
        happened = self._take_outside() | self._take_reports() | self._watch_the_clock()
        if self._is_outdated:
            self._waiting_since.clear()
        else:
            happened |= self._send_what_is_ready()
        if not self._progress.under_way and not set(self._waiting_since) - self.course.lost:
            self._conclude()
        elif self._is_time_up():
            self._bring(Notice(Event.TIME_UP, reason=Ending.TIME.value))
        elif not happened:
            self._pause(_PAUSE_S)

    def _adopt(self, schedule: Schedule) -> None:
        """Begin to carry out a schedule, or go on without one if the course says that it is none."""
        self._progress = Progress(schedule)
        self._waiting_since.clear()
        self._is_outdated = not self._bring(Notice(Event.PLAN_READY, plan=schedule.actions))
        if self._is_outdated:
            self._bring(Notice(Event.PLANNER_FAILED))
        self._bring(Notice(Event.TEAM_NEXT))

    def _now(self) -> float:
        return self._clock() - self._began

    def _is_time_up(self) -> bool:
        return self._now() > self._limits.total_s

    def _conclude(self) -> None:
        """End, or plan anew, now that nothing is under way and nothing can be sent."""
        if self.course.has_reached_goal:
            self._bring(Notice(Event.GOAL_HOLDS))
        elif self._num_plans >= self._limits.max_plans:
            self._bring(Notice(Event.TIME_UP, reason=Ending.STUCK.value))
        elif self._is_time_up():
            self._bring(Notice(Event.TIME_UP, reason=Ending.TIME.value))
        else:
            self._plan_anew()

    def _plan_anew(self) -> None:
        self._num_plans += 1
        self._bring(Notice(Event.PLAN_OUTDATED))
        began = self._clock()
        schedule = self._replan(self.course.problem_from_now)
        self._planning_s.append(self._clock() - began)
        if schedule is None:
            self._bring(Notice(Event.NO_PLAN_EXISTS))
        elif set(schedule.agents) - set(self._crew) or not self.course.leads_to_goal(schedule.actions):
            self._bring(Notice(Event.PLANNER_FAILED))
            self._bring(Notice(Event.TIME_UP, reason=Ending.STUCK.value))
        else:
            self._adopt(schedule)

    def _check_rest(self) -> None:
        """Find out whether what is left still leads to the goal, if those who are lost come back."""
        state = self._truth.follow(self.course.state, self._progress.rest)
        self._is_outdated |= state is None or not self._truth.task.is_goal(state)

    def _send_what_is_ready(self) -> bool:
        busy = self._progress.busy | self.course.lost
        sent = False
        for number, step in self._progress.ready():
            if step.agent in busy:
                continue
            if not self.course.allows(step.action):
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
                self._bring(Notice(Event.AGENT_LOST, agent=step.agent, reason="out of reach"))
            return False
        self._waiting_since.pop(step.agent, None)
        self._progress.under_way[number] = Sent(self._progress.schedule, number, order, self._now())
        return self._bring(Notice(Event.ROBOT_NEXT, step.action))

    def _take_reports(self) -> bool:
        happened = False
        for name, member in self._crew.items():
            report = member.poll()
            if report is not None:
                happened = True
                self._take(name, report)
        return happened

    def _take(self, name: str, report: Report) -> None:
        if name in self._given_up and not isinstance(report, Observation):  # it was not lost after all
            returned = self._given_up.pop(name)
            self._bring(Notice(Event.AGENT_BACK, agent=name))
            if returned.schedule is not self._progress.schedule:
                self._end_late(returned, report)
                return
            self._progress.under_way[returned.number] = returned
        sent = self._progress.sent_to(name)
        if isinstance(report, Observation) or sent is None:
            self._see(name, facts_of(report), is_moving=sent is not None)
        else:
            self._end(sent, report)

    def _see(self, name: str, facts: Iterable[Fact], *, is_moving: bool) -> None:
        """Take in what a robot sees: of fixed things at once, of things in motion when its step is over."""
        fixed: list[Fact] = []
        for fact in facts:
            (fixed if fact.atom in self._truth.stage.beliefs else self._seen[name]).append(fact)
        self._learn(fixed)
        if not is_moving:
            self._learn(self._seen.pop(name, []))

    def _end(self, sent: Sent, report: Report) -> None:
        """Let a step of the present plan end, well or not."""
        step = sent.step
        del self._progress.under_way[sent.number]
        self._history.append(Dispatched(step, sent.time_s, self._now(), report))
        if isinstance(report, Finished) and self._bring(Notice(Event.STEP_FINISHED, step.action)):
            self._progress.done.add(sent.number)
        else:
            reason = "blocked" if isinstance(report, Blocked) else getattr(report, "reason", "")
            self._bring(Notice(Event.STEP_FAILED, step.action, reason=reason))
            self._is_outdated |= isinstance(report, Finished)  # it can't have been done, as far as is known
        is_news = self._learn((*self._seen.pop(step.agent, []), *facts_of(report)))
        if isinstance(report, Failed) or (isinstance(report, Blocked) and not is_news):
            self._fail(sent)

    def _end_late(self, sent: Sent, report: Report) -> None:
        """Let a step end that is none of the present plan's."""
        step = sent.step
        self._history.append(Dispatched(step, sent.time_s, self._now(), report))
        if not (isinstance(report, Finished) and self._bring(Notice(Event.STEP_FINISHED, step.action))):
            self._bring(Notice(Event.STEP_FAILED, step.action))
        self._learn((*self._seen.pop(step.agent, []), *facts_of(report)))
        self._check_rest()

    def _learn(self, facts: Iterable[Fact]) -> bool:
        """Take facts for true; whether that is news."""
        found = tuple(facts)
        before = self.course.state
        if found and self.course.is_news(found):
            self._bring(Notice(Event.FACT_OBSERVED, facts=found))
        is_news = self.course.state != before
        if is_news:
            self._check_rest()
        return is_news

    def _fail(self, sent: Sent) -> None:
        """Let a failed step be tried again, until its failing says something about the world."""
        failures = self._progress.failures
        failures[sent.number] += 1
        if failures[sent.number] >= self._limits.attempts:
            fact = most_specific(self._truth.stage, sent.step.action)
            self._learn([fact] if fact else [])
            self._is_outdated = True

    def _take_outside(self) -> bool:
        happened = False
        while self._outside:
            action = self._outside.popleft()
            if not self._bring(Notice(Event.PERSON_COMMANDED, action)):
                continue
            happened = True
            agent = self.course.agent_of(action)
            self._history.append(Dispatched(Step(agent, action), self._now(), self._now(), None))
            self._progress.count_as_done(action)
            self._check_rest()
        return happened

    def _watch_the_clock(self) -> bool:
        happened = False
        for sent in list(self._progress.under_way.values()):
            step, waited_s = sent.step, self._now() - sent.time_s
            if waited_s > self._limits.step_s and not sent.is_cancelled:
                sent.is_cancelled = True
                self._bring(Notice(Event.TIME_PASSED, step.action))
                self._crew[step.agent].cancel()
                happened = True
            if waited_s > 2 * self._limits.step_s:
                self._bring(Notice(Event.AGENT_LOST, agent=step.agent, reason="no answer"))
                self._given_up[step.agent] = self._progress.under_way.pop(sent.number)
                self._history.append(Dispatched(step, sent.time_s, self._now(), None))
                happened = True
        return happened

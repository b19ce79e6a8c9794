"""The robots of a team as the loop sees them: a step at a time goes out, notices come in."""

import time
from collections.abc import Callable, Iterable

from explicable.errors import UsageError
from explicable.execution.course import Course
from explicable.execution.monitor import Event
from explicable.execution.notices import Notice
from explicable.execution.robots.door import Door
from explicable.execution.robots.faultless import FaultlessRobot
from explicable.execution.robots.protocol import Blocked, Finished, Observation, Order, Refused, Report, Robot
from explicable.execution.setting import Setting
from explicable.model.problem import GroundAtom


class Crew:
    """All robots of a game, of which one is about a step.

    Parameters
    ----------
    course
        The game.
    robots
        One for each robot of the team, each behind a door that checks what it reports; None: their steps all
        succeed.
    step_s
        Seconds after which a robot is asked to give its step up; after as long again it is lost.
    clock
        In seconds.

    Raises
    ------
    UsageError
        If there is not one for each robot of the team.
    """

    def __init__(
        self,
        course: Course,
        robots: Iterable[Robot] | None,
        step_s: float,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self._course, self._step_s, self._clock = course, step_s, clock
        self._robots = _named(course.setting, robots)
        self._at_work: Robot | None = None
        self._num_orders = 0
        self._sent_at = 0.0
        self._is_cancelled = False

    def send(self, action: GroundAtom) -> Notice | None:
        """Send a robot out; returns that the step has failed if it can't be."""
        self._at_work = self._robots[self._course.setting.problem.agent_of(action).name]
        self._num_orders += 1
        self._sent_at, self._is_cancelled = self._clock(), False
        answer = self._at_work.send(Order(self._num_orders, action))
        if isinstance(answer, Refused):
            return Notice(Event.STEP_FAILED, action, reason=answer.reason)
        return None

    def cancel(self) -> None:
        """Ask the robot at work to give its step up."""
        if self._at_work is not None:
            self._at_work.cancel()
        self._is_cancelled = True

    def hear(self, action: GroundAtom, timeout_s: float = 0.05) -> list[Notice]:
        """Return what the robot at work says, or that it takes too long; nothing if it is silent."""
        report = self._at_work.poll(timeout_s) if self._at_work is not None else None
        if report is not None:
            return self._read(report, action)
        waited_s = self._clock() - self._sent_at
        if waited_s > 2 * self._step_s and self._at_work is not None:
            return [Notice(Event.AGENT_LOST, action, agent=self._at_work.name, reason="the robot is lost")]
        if waited_s > self._step_s and not self._is_cancelled:
            return [Notice(Event.TIME_PASSED, action)]
        return []

    def _read(self, report: Report, action: GroundAtom) -> list[Notice]:
        if isinstance(report, Observation):
            return [Notice(Event.FACT_OBSERVED, facts=report.facts)]
        if isinstance(report, Finished):
            seen = [Notice(Event.FACT_OBSERVED, facts=report.facts)] if report.facts else []
            return [Notice(Event.STEP_FINISHED, action), *seen]
        if isinstance(report, Blocked) and self._course.is_news(report.facts):
            failed = Notice(Event.STEP_FAILED, action, reason="blocked")
            return [Notice(Event.FACT_OBSERVED, facts=report.facts), failed]
        reason = "blocked" if isinstance(report, Blocked) else report.reason
        concluded = () if self._is_cancelled else self._course.conclude(action)
        facts = [Notice(Event.FACT_OBSERVED, facts=concluded, reason="concluded")] if concluded else []
        return [Notice(Event.STEP_FAILED, action, reason=reason), *facts]


def _named(setting: Setting, robots: Iterable[Robot] | None) -> dict[str, Robot]:
    names = [agent.name for agent in setting.problem.agents if agent.kind == "robot"]
    if robots is None:
        return {name: FaultlessRobot(name) for name in names}
    named: dict[str, Robot] = {robot.name: Door(robot, setting.truth.task) for robot in robots}
    if sorted(named) != sorted(names):
        raise UsageError(f"robots are needed for {', '.join(names)}, not for {', '.join(named) or 'none'}")
    return named

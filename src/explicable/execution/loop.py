"""The closed loop: the robot plans, a person acts and judges, the robot replans when the plan no longer fits.

`monitor` says what to do about each event, `course` what follows for the game. Here events are fetched from
robots, planner and person, and what is to be done outside is done. Planners and robots are handed in.
"""

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType

from explicable.execution.course import Course
from explicable.execution.crew import Crew
from explicable.execution.desk import BackDesk, Desk, OpenDesk
from explicable.execution.episodes import Ending
from explicable.execution.humans import Humans
from explicable.execution.monitor import FINAL, Command, Event, State
from explicable.execution.notices import Notice
from explicable.execution.people import Person
from explicable.execution.plans import Planner
from explicable.execution.robots.protocol import Robot
from explicable.execution.runs import USUAL_LIMITS, Limits, Run
from explicable.execution.setting import Setting
from explicable.model.problem import GroundAtom
from explicable.search import Outcome


def run(
    setting: Setting,
    planner: Planner,
    person: Person | Sequence[Person],
    robots: Iterable[Robot] | None = None,
    *,
    limits: Limits = USUAL_LIMITS,
    background: bool = False,
    clock: Callable[[], float] = time.perf_counter,
    watch: Callable[[Course], None] = lambda _: None,
) -> Run:
    """Play one game in which the robot follows a joint plan that predicts the person.

    A person without a request under way makes one; otherwise it thinks over what it wants after robot steps.
    The plan is made again when the person does something else than predicted, when a fact turns out to be
    otherwise, and when it does not lead to the goal any more. If the planner fails or is late, or a predicted
    step of the person does not come, the robot does the safe thing: it follows the last request by a shortest
    way, or waits. No step is sent that is not possible as far as is known.

    Parameters
    ----------
    setting
        The team problem, prepared by `prepare`.
    planner
        Called with the situation. Plans that do not lead to the goal count as failures; no step of them is
        sent.
    person, robots
        Who plays; by default the robots' steps all succeed. What robots report is checked
        (`explicable.execution.robots.Door`). They are left open. A person alone may take any human step; of
        several, in the order of the team's humans, each takes their own. All judge each step; a step's label
        in the trace is whether all who answered found it explicable.
    limits
        How long to wait for what.
    background
        Whether the robot moves on while a plan is made that is late. Without it each game can be repeated.
    clock
        For the times in the record and for limits, in seconds.
    watch
        Called after every event.

    Returns
    -------
    Run
        It always ends; how, its episode says.
    """
    return ClosedLoop(
        setting, planner, person, robots, limits=limits, background=background, clock=clock, watch=watch
    ).run()


class ClosedLoop:
    """A game under way, for those who bring events in from outside or may break it off; see `run`.

    Raises
    ------
    UsageError
        If there is not one robot for each of the team's, or several people but not one for each human.
    """

    def __init__(
        self,
        setting: Setting,
        planner: Planner,
        person: Person | Sequence[Person],
        robots: Iterable[Robot] | None = None,
        *,
        limits: Limits = USUAL_LIMITS,
        background: bool = False,
        clock: Callable[[], float] = time.perf_counter,
        watch: Callable[[Course], None] = lambda _: None,
    ) -> None:
        self.course = Course(setting)
        people = tuple(person) if isinstance(person, Sequence) else (person,)
        self._humans = Humans(self.course, people)
        self._limits, self._clock, self._watch = limits, clock, watch
        self._crew = Crew(self.course, robots, limits.step_s, clock)
        self._desk: Desk = BackDesk(planner, clock) if background else OpenDesk(planner, clock)
        self._began = self._requested_at = clock()
        self._inbox: deque[Notice] = deque()
        self._outside: deque[Notice] = deque()
        self._kept: deque[Notice] = deque()
        self._has_planned = False  # since the last step
        self._idle_events = 0

    def run(self) -> Run:
        """Play to the end; a Ctrl-C aborts the game, whose result is still there, and goes on up."""
        try:
            while self.course.monitor not in FINAL:
                notice, from_outside = self._next()
                if notice is not None:
                    self._handle(notice, from_outside)
        except KeyboardInterrupt:
            if self.course.monitor not in FINAL:
                self._handle(Notice(Event.ABORT), from_outside=False)
            raise
        finally:
            self._desk.close()
        return self.result()

    def notify(self, notice: Notice) -> None:
        """Bring an event in from outside, from any thread; what can't be is noted and changes nothing."""
        self._outside.append(notice)

    def abort(self) -> None:
        """Let the game end as soon as can be; may be called from any thread."""
        self.notify(Notice(Event.ABORT))

    def result(self) -> Run:
        """Return the game that has ended.

        Raises
        ------
        UsageError
            If it has not.
        """
        return Run.of(self.course, self._humans.names, self._humans.origin, self._desk.planning_s)

    def _next(self) -> tuple[Notice | None, bool]:
        """Return the next notice, and whether it comes from outside."""
        if self._inbox:
            return self._inbox.popleft(), False
        if self._outside:
            return self._outside.popleft(), True
        state = self.course.monitor
        if self._kept and state not in (State.ACTING, State.BRIDGING):
            return self._kept.popleft(), True
        return self._time_up() or _SOURCES[state](self), False

    def _time_up(self) -> Notice | None:
        """Return that the game is over, if it has taken too long without reaching the goal."""
        limits, ending = self._limits, None
        if len(self.course.steps) >= limits.max_steps:
            ending = Ending.LIMIT
        elif self._idle_events > limits.patience:
            ending = Ending.STUCK
        elif self._clock() - self._began > limits.game_s:
            ending = Ending.TIME
        if ending is None or self.course.has_reached_goal:
            return None
        return Notice(Event.TIME_UP, reason=ending.value)

    def _handle(self, notice: Notice, from_outside: bool) -> None:
        course = self.course
        before, num_steps, request = course.state, len(course.steps), course.request
        commands = course.apply(notice, self._clock() - self._began)
        self._idle_events += 1
        if course.occurrences[-1].refusal:
            if not from_outside:
                self._make_good(notice)
        elif len(course.steps) > num_steps:
            self._inbox.extend(self._humans.see(notice.action, before, ask=Command.ASK_PERSON in commands))
            self._has_planned, self._idle_events = False, 0
        elif notice.event is Event.FACT_OBSERVED:
            self._has_planned = False
        for command in commands:
            effect = _EFFECTS.get(command)
            if effect is not None:
                effect(self, notice)
        if request is not None and Command.ADOPT_SAFE_PLAN in commands and request.action in course.refused:
            self._humans.give_up(request)
        self._watch(course)

    def _make_good(self, notice: Notice) -> None:
        """Answer for what robot, planner or person said and could not be."""
        instead = {Event.STEP_FINISHED: Event.STEP_FAILED, Event.PLAN_READY: Event.PLANNER_FAILED}
        if notice.event in instead:
            reason = self.course.occurrences[-1].refusal
            self._inbox.append(Notice(instead[notice.event], notice.action, reason=reason))

    def _refuse(self, asked: GroundAtom) -> None:
        """Note that a person has asked for what is not possible."""
        self._handle(Notice(Event.PERSON_COMMANDED, asked), from_outside=False)

    def _decide(self) -> Notice:
        course = self.course
        if course.has_reached_goal:
            return Notice(Event.GOAL_HOLDS)
        if not course.plan and not self._has_planned:  # predict before the person acts
            return Notice(Event.PLAN_OUTDATED)
        if asked := self._humans.act(self._refuse):
            return Notice(Event.PERSON_COMMANDED, asked)
        if not course.plan or (course.is_outdated and not self._has_planned):
            return Notice(Event.PLAN_OUTDATED)
        action = course.plan[0]
        if course.is_human(action):
            return Notice(Event.PERSON_NEXT, action)
        return Notice(Event.ROBOT_NEXT if course.allows(action) else Event.PLAN_OUTDATED, action)

    def _listen(self) -> Notice:
        asked = self._humans.choose(self._refuse)
        return Notice(Event.PERSON_COMMANDED, asked) if asked else Notice(Event.PERSON_IDLE)

    def _keep(self, notice: Notice) -> None:
        self._kept.append(notice)

    def _send_step(self, notice: Notice) -> None:
        failed = self._crew.send(notice.action)
        if failed is not None:
            self._inbox.append(failed)

    def _cancel_step(self, _: Notice) -> None:
        self._crew.cancel()

    def _cancel_planner(self, _: Notice) -> None:
        self._desk.cancel()

    def _hear_robot(self) -> Notice | None:
        notices = self._crew.hear(self.course.step_under_way)
        self._inbox.extend(notices[1:])
        return notices[0] if notices else None

    def _request_plan(self, _: Notice) -> None:
        self._has_planned, self._requested_at = True, self._clock()
        self._desk.request(self.course.situation)

    def _hear_planner(self) -> Notice:
        if self.course.has_reached_goal:
            return Notice(Event.GOAL_HOLDS)
        waited_s = self._clock() - self._requested_at
        step = self._bridge() if waited_s > self._limits.plan_s else ()
        proposal = self._propose(0.0 if step else self._limits.plan_s)
        if proposal is not None:
            return proposal
        step = self._bridge()
        if step:
            return Notice(Event.ROBOT_NEXT, step)
        asked = self._humans.choose(self._refuse) if self._humans.want_nothing else ()
        return Notice(Event.PERSON_COMMANDED, asked) if asked else Notice(Event.TIME_PASSED)

    def _propose(self, timeout_s: float) -> Notice | None:
        proposal = self._desk.poll(timeout_s)
        if proposal is None:
            return None
        if proposal.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if proposal.outcome is Outcome.SOLVED:
            return Notice(Event.PLAN_READY, plan=proposal.actions)
        none_exists = proposal.outcome is Outcome.UNSOLVABLE
        return Notice(Event.NO_PLAN_EXISTS if none_exists else Event.PLANNER_FAILED)

    def _bridge(self) -> GroundAtom:
        """Return what the robot does while the plan is late: the safe thing, or the next of the old plan."""
        course = self.course
        step = course.safe_step() or (course.plan[0] if course.plan else ())
        return step if step and not course.is_human(step) and course.allows(step) else ()

    def _hear_both(self) -> Notice | None:
        return self._propose(0.0) or self._hear_robot()


_SOURCES: Mapping[State, Callable[[ClosedLoop], Notice | None]] = MappingProxyType(
    {
        State.DECIDING: ClosedLoop._decide,
        State.LISTENING: ClosedLoop._listen,
        State.ACTING: ClosedLoop._hear_robot,
        State.PLANNING: ClosedLoop._hear_planner,
        State.BRIDGING: ClosedLoop._hear_both,
    }
)
_EFFECTS: Mapping[Command, Callable[[ClosedLoop, Notice], None]] = MappingProxyType(
    {
        Command.SEND_STEP: ClosedLoop._send_step,
        Command.CANCEL_STEP: ClosedLoop._cancel_step,
        Command.REQUEST_PLAN: ClosedLoop._request_plan,
        Command.CANCEL_PLANNER: ClosedLoop._cancel_planner,
        Command.KEEP_PERSON_STEP: ClosedLoop._keep,
    }
)

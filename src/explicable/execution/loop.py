"""The closed loop: the robot plans, a person acts and judges, the robot replans when the plan no longer fits.

`monitor` says what to do about each event; here it is done, and only here. Planners and robots are handed in.
"""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

from explicable.execution.episodes import Ending, Episode, Game, follow
from explicable.execution.monitor import FINAL, Command, Event, State, react
from explicable.execution.people import Person
from explicable.execution.setting import Setting
from explicable.model.problem import GroundAtom
from explicable.search import Outcome

Actions = tuple[GroundAtom, ...]

_PATIENCE = 20
"""Events without a step of anybody after which nothing more is to be expected."""


@dataclass(frozen=True, slots=True)
class Proposal:
    """What a planner answers: how its search ended, and the joint plan from now on if there is one."""

    outcome: Outcome
    actions: Actions = ()


Planner = Callable[[Actions], Proposal]
"""Plans the rest of a game from the steps already done: what is explicable depends on them."""


class Robot(Protocol):
    """What the loop asks of a robot."""

    def execute(self, action: GroundAtom) -> bool:
        """Carry out a step; False if it failed and changed nothing."""


class FaultlessRobot:
    """A robot whose steps all succeed."""

    def execute(self, action: GroundAtom) -> bool:  # noqa: ARG002
        """Succeed."""
        return True


@dataclass(frozen=True, slots=True)
class Occurrence:
    """One event of a run.

    Parameters
    ----------
    event
        What happened.
    action
        The step it was about; empty if about none.
    time_s
        Seconds since the run began.
    """

    event: Event
    action: GroundAtom
    time_s: float


@dataclass(frozen=True, slots=True)
class Run:
    """A closed-loop game played to its end.

    Parameters
    ----------
    episode
        The trace and how the game ended.
    occurrences
        Everything that happened, in order.
    num_deviations
        Steps of the person that were not the next predicted ones.
    num_changes
        Requests made while another was under way.
    planning_s
        How long each call of the planner took, in seconds; the first made the first plan, the others were
        replans.
    """

    episode: Episode
    occurrences: tuple[Occurrence, ...]
    num_deviations: int
    num_changes: int
    planning_s: tuple[float, ...]


def run(
    setting: Setting,
    planner: Planner,
    person: Person,
    robot: Robot | None = None,
    *,
    max_steps: int = 1000,
    clock: Callable[[], float] = time.perf_counter,
) -> Run:
    """Play one game in which the robot follows a joint plan that predicts the person.

    A person without a request under way makes one; otherwise it thinks over what it wants after robot
    steps. As long as the plan, less the steps of the person that came early, still leads to the goal, it is
    kept. If the planner fails, or a predicted step of the person does not come, the robot does the safe
    thing: it follows the last request by a shortest way, or waits.

    Parameters
    ----------
    setting
        The team problem, prepared by `prepare`.
    planner
        Called with all steps so far. Plans that the truth does not allow count as failures; no step of them
        is sent.
    person, robot
        Who plays; by default the robot's steps all succeed.
    max_steps
        Most steps of the whole team.
    clock
        For the times in the record, in seconds.

    Returns
    -------
    Run
        It always ends; how, its episode says.
    """
    return _Loop(setting, planner, person, robot or FaultlessRobot(), max_steps, clock).run()


class _Loop:
    def __init__(
        self,
        setting: Setting,
        planner: Planner,
        person: Person,
        robot: Robot,
        max_steps: int,
        clock: Callable[[], float],
    ) -> None:
        self.setting, self.planner, self.person, self.robot = setting, planner, person, robot
        self.max_steps, self.clock, self.began = max_steps, clock, clock()
        self.game = Game(setting, person)
        self.plan: Actions = ()
        self.proposal = Proposal(Outcome.LIMIT)
        self.step_succeeded = False
        self.refused: frozenset[GroundAtom] = frozenset()
        self.robot_moved = False
        self.has_planned = False  # since the last step
        self.idle_events = 0
        self.occurrences: list[Occurrence] = []
        self.planning_s: list[float] = []
        self.num_deviations = self.num_changes = 0
        # Robot, planner and person answer at once here: nothing is ever under way that could be cancelled or
        # kept, so the other commands have no effect.
        self.effects: dict[Command, Callable[[GroundAtom], None]] = {
            Command.SEND_STEP: self.send_step,
            Command.REQUEST_PLAN: self.request_plan,
            Command.ADOPT_PLAN: self.adopt_plan,
            Command.ADOPT_SAFE_PLAN: self.adopt_safe_plan,
            Command.TAKE_ROBOT_STEP: self.take_robot_step,
            Command.TAKE_PERSON_STEP: self.take_person_step,
        }

    def run(self) -> Run:
        state = State.DECIDING
        while state not in FINAL:
            event, action = self.next_event(state)
            state, commands = react(state, event)
            self.occurrences.append(Occurrence(event, action, self.clock() - self.began))
            self.idle_events += 1
            for command in commands:
                if command in self.effects:
                    self.effects[command](action)
        return Run(
            self.game.ended(self.ending(state)),
            tuple(self.occurrences),
            self.num_deviations,
            self.num_changes,
            tuple(self.planning_s),
        )

    def ending(self, state: State) -> Ending:
        if state is State.REACHED:
            return Ending.REACHED
        return Ending.LIMIT if len(self.game.steps) >= self.max_steps else Ending.STUCK

    def next_event(self, state: State) -> tuple[Event, GroundAtom]:
        if state is State.DECIDING:
            return self.decide()
        if state is State.LISTENING:
            asked = self.person_chooses()
            return (Event.PERSON_ACTED, asked) if asked else (Event.PERSON_IDLE, ())
        if state is State.ACTING:
            return (Event.STEP_FINISHED if self.step_succeeded else Event.STEP_FAILED), self.plan[0]
        answers = {Outcome.SOLVED: Event.PLAN_READY, Outcome.UNSOLVABLE: Event.NO_PLAN_EXISTS}
        return answers.get(self.proposal.outcome, Event.PLANNER_FAILED), ()

    def decide(self) -> tuple[Event, GroundAtom]:
        if self.game.is_over:
            return Event.GOAL_HOLDS, ()
        if len(self.game.steps) >= self.max_steps or self.idle_events > _PATIENCE:
            return Event.TIME_UP, ()
        if not self.plan and not self.has_planned:  # predict before the person acts
            return Event.PLAN_BROKEN, ()
        if self.person.request is None or (self.robot_moved and self.person.thinks_over()):
            self.robot_moved = False
            asked = self.person_chooses()
            if asked:
                return Event.PERSON_ACTED, asked
        if not self.plan:
            return Event.PLAN_BROKEN, ()
        action = self.plan[0]
        if self.is_human(action):
            return Event.PERSON_NEXT, action
        return (Event.ROBOT_NEXT, action) if self.game.allows(action) else (Event.PLAN_BROKEN, ())

    def person_chooses(self) -> GroundAtom:
        """Ask the person for a step until it names one that is possible, or none."""
        while (asked := self.person.choose(self.refused)) and not self.game.allows(asked):
            self.refused |= {asked}
        return asked or ()

    def send_step(self, action: GroundAtom) -> None:
        self.step_succeeded = self.robot.execute(action)

    def take_robot_step(self, action: GroundAtom) -> None:
        self.take(action)
        self.plan = self.plan[1:]
        self.robot_moved = True

    def take_person_step(self, action: GroundAtom) -> None:
        predicted = next((step for step in self.plan if self.is_human(step)), None)
        self.num_deviations += action != predicted
        self.num_changes += self.person.request is not None
        self.take(action)
        self.robot_moved = False
        rest = list(self.plan)
        if action in rest:
            rest.remove(action)
        self.plan = tuple(rest) if self.reaches_goal(rest) else ()

    def take(self, action: GroundAtom) -> None:
        self.game.take(action)
        self.has_planned = False
        self.idle_events = 0

    def request_plan(self, _: GroundAtom) -> None:
        self.has_planned = True
        began = self.clock()
        self.proposal = self.planner(tuple(step.action for step in self.game.steps))
        self.planning_s.append(self.clock() - began)
        if self.proposal.outcome is Outcome.SOLVED and not self.reaches_goal(self.proposal.actions):
            self.proposal = Proposal(Outcome.LIMIT)

    def adopt_plan(self, _: GroundAtom) -> None:
        self.plan = self.proposal.actions

    def adopt_safe_plan(self, _: GroundAtom) -> None:
        truth, request = self.setting.truth, self.person.request
        self.plan = ()
        if request is None:
            action = follow(truth, self.game.state, None, "autonomous")
            self.plan = (action,) if action else ()
            return
        way = truth.fulfilment_way(self.game.state, request)
        if way is None:
            self.refused |= {request.action}
            self.person.give_up(request)
        else:
            self.plan = tuple(truth.task.action(operator) for operator in way)

    def is_human(self, action: GroundAtom) -> bool:
        return self.setting.problem.agent_of(action).kind == "human"

    def reaches_goal(self, actions: Iterable[GroundAtom]) -> bool:
        truth, state = self.setting.truth, self.game.state
        for action in actions:
            operator = truth.operator(state, action)
            if operator is None:
                return False
            state = truth.task.successor(state, operator)
        return truth.task.is_goal(state)

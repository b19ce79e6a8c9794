"""A task under way: what may happen next, and what follows from it. No input, no output, no clock.

A task is played (the robot follows the person's commands) or replayed (the steps of a given plan are shown).
Either way its whole state is a `Moment`: the steps so far with their labels, and the step that is announced.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal, TypeAlias

from explicable.execution.episodes import Way, follow
from explicable.labelling.traces import LabelledStep
from explicable.model.plan import format_action
from explicable.study.protocol import ConflictError

if TYPE_CHECKING:
    from explicable.execution.setting import Setting
    from explicable.model.problem import GroundAtom
    from explicable.model.requests import Request
    from explicable.model.task import State

Ask = Literal["after", "before"]
Next = Callable[["State", "tuple[GroundAtom, ...]", "Request | None"], "GroundAtom | None"]
"""Chooses the next step from the state, the actions so far and the present request; None: wait."""

Situation: TypeAlias = "tuple[State, tuple[Request, ...]]"
"""The state, and what was asked for and not got."""


@dataclass(frozen=True, slots=True)
class Moment:
    """Where a task stands.

    Parameters
    ----------
    steps
        The steps so far; a robot's step without a label is the one asked about.
    announced
        The robot's next step, where people are asked before it is taken.
    situation
        What the steps have led to, where the game has worked it out.
    """

    steps: tuple[LabelledStep, ...] = ()
    announced: "GroundAtom | None" = None
    situation: "Situation | None" = field(default=None, compare=False, repr=False)

    @property
    def actions(self) -> "tuple[GroundAtom, ...]":
        """The steps' actions."""
        return tuple(step.action for step in self.steps)

    @property
    def operator(self) -> str | None:
        """The step announced, or else the last one, as PDDL writes it."""
        if self.announced:
            return format_action(self.announced)
        return format_action(self.steps[-1].action) if self.steps else None


@dataclass(frozen=True)
class Game:
    """The rules of one task.

    Parameters
    ----------
    setting
        The team problem, prepared for play.
    ask
        Whether people are asked about a robot's step after or before it is taken.
    choose
        The next step; see `play_by_commands` and `replay`.
    length
        Number of steps of a replayed plan; None for play, which ends at the goal.
    expected
        What the person was predicted to do next, by the actions so far, where the robot predicts it.
    """

    setting: "Setting"
    ask: Ask
    choose: Next
    length: int | None = None
    expected: "Callable[[tuple[GroundAtom, ...]], GroundAtom | None]" = lambda _: None

    def moment(self, steps: tuple[LabelledStep, ...], announced: "GroundAtom | None") -> Moment:
        """Return where the task stands after some steps."""
        return Moment(steps, announced, self._situation(Moment(steps)))

    def state(self, moment: Moment) -> "State":
        """Return the true state, in which all the steps have been taken."""
        return self._situation(moment)[0]

    def question(self, moment: Moment) -> "GroundAtom | None":
        """Return the robot's step that the person is asked about, if there is one."""
        if self.ask == "before":
            return moment.announced
        index = self._unlabelled(moment)
        return None if index is None else moment.steps[index].action

    def is_over(self, moment: Moment) -> bool:
        """Tell whether nothing is left to do, or to answer."""
        if self.question(moment) is not None:
            return False
        if self.length is not None:
            return len(moment.steps) >= self.length
        return self.setting.truth.task.is_goal(self.state(moment))

    def request(self, moment: Moment) -> "Request | None":
        """Return the last thing asked for that has neither been got nor withdrawn."""
        state, asked = self._situation(moment)
        return next((r for r in reversed(asked) if self.setting.truth.stands(state, r)), None)

    def commands(self, moment: Moment) -> "tuple[GroundAtom, ...]":
        """Return what the person can ask for now; nothing where a plan is replayed."""
        if self.length is not None or self.setting.truth.task.is_goal(self.state(moment)):
            return ()
        truth, state = self.setting.truth, self.state(moment)
        return tuple(sorted(action for action in truth.requests if truth.operator(state, action) is not None))

    def upcoming(self, moment: Moment) -> "GroundAtom | None":
        """Return the step that would come next; None where the robot waits, or for an answer."""
        if self.question(moment) is not None or self.is_over(moment):
            return None
        return self.choose(self.state(moment), moment.actions, self.request(moment))

    def step(self, moment: Moment) -> Moment:
        """Take the next step, or announce it where people are asked before.

        Raises
        ------
        ConflictError
            If an answer is still due, the robot waits for a command, or the task is over.
        """
        action = self.upcoming(moment)
        if action is None:
            raise ConflictError("nothing is to be done now but to answer, or to command")
        return self._begin(moment, action)

    def offer(self, moment: Moment) -> Moment | None:
        """Return the task with the next step shown, where that is the robot's: people are asked about it."""
        action = self.upcoming(moment)
        return self._begin(moment, action) if action is not None and self._is_robots(action) else None

    def answer(self, moment: Moment, *, explicable: bool) -> Moment:
        """Label the step that is asked about; an announced one is then taken.

        Raises
        ------
        ConflictError
            If nothing is asked.
        """
        if moment.announced is not None:
            return self._take(moment, moment.announced, explicable)
        index = self._unlabelled(moment) if self.ask == "after" else None
        if index is None:
            raise ConflictError("there is no question to answer now")
        labelled = replace(moment.steps[index], label=explicable)
        return replace(moment, steps=(*moment.steps[:index], labelled, *moment.steps[index + 1 :]))

    def command(self, moment: Moment, action: "GroundAtom") -> Moment:
        """Take a step of the person's; an announced step is withdrawn, so that the robot can think again.

        Raises
        ------
        ConflictError
            If that can't be asked for now, as with a visited room.
        """
        if action not in self.commands(moment):
            raise ConflictError("that can't be commanded now")
        return self._take(moment, action, None)

    def _situation(self, moment: Moment) -> "Situation":
        """Return the state, and what was asked for and not got, the latest last."""
        if moment.situation is not None:
            return moment.situation
        situation: Situation = (self.setting.truth.task.initial_state, ())
        for action in moment.actions:
            situation = self._after(situation, action)
        return situation

    def _after(self, situation: "Situation", action: "GroundAtom") -> "Situation":
        truth, (state, asked) = self.setting.truth, situation
        after = truth.after(state, action)
        if after is None:
            raise ConflictError("that step is not possible now")
        request = truth.requests.get(action)
        left = tuple(r for r in asked if action not in r.fulfilled_by and r is not request)
        return after, (*left, request) if request else left

    def _begin(self, moment: Moment, action: "GroundAtom") -> Moment:
        if self.ask == "before" and self._is_robots(action):
            return replace(moment, announced=action)
        return self._take(moment, action, None)

    def _take(self, moment: Moment, action: "GroundAtom", label: bool | None) -> Moment:
        step = LabelledStep(self.setting.problem.agent_of(action).name, action, label)
        situation = self._after(self._situation(moment), action)  # raises if the step is not possible
        return Moment((*moment.steps, step), situation=situation)

    def _is_robots(self, action: "GroundAtom") -> bool:
        return self.setting.problem.agent_of(action).kind == "robot"

    def _unlabelled(self, moment: Moment) -> int | None:
        for index in range(len(moment.steps) - 1, -1, -1):
            step = moment.steps[index]
            if self._is_robots(step.action):
                return index if step.label is None else None
        return None


def play_by_commands(setting: "Setting", way: Way) -> Next:
    """Let the robot follow the last command by a shortest way, or lead where it plays autonomously."""

    def choose(state: "State", _: "tuple[GroundAtom, ...]", request: "Request | None") -> "GroundAtom | None":
        return follow(setting.truth, state, request, way)

    return choose


def replay(plan: "tuple[GroundAtom, ...]") -> Next:
    """Show the steps of a plan, whoever takes them."""

    def choose(_: "State", actions: "tuple[GroundAtom, ...]", __: "Request | None") -> "GroundAtom | None":
        return plan[len(actions)] if len(actions) < len(plan) else None

    return choose

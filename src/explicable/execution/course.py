"""The course of a game: what has happened so far and what follows from it, without anything from outside.

`loop` brings events in and does outside what they lead to. Given the same notices, a course takes the same
states: so a game on record can be replayed.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from explicable.errors import PlanError
from explicable.execution.facts import change_state, correct_model, most_specific
from explicable.execution.monitor import Command, Event, IllegalEventError, react
from explicable.execution.notices import Notice, Occurrence
from explicable.execution.objections import object_to
from explicable.execution.position import Position
from explicable.execution.robots.protocol import Fact
from explicable.labelling.records import LabelledStep
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom

_FAILURES = 3
"""How often a step fails before it is put down to a fact."""


class Course(Position):
    """A game under way; see the module.

    Parameters
    ----------
    setting, at_once
        As of `Position`.
    """

    def apply(self, notice: Notice, time_s: float) -> tuple[Command, ...]:
        """Take a notice.

        Returns
        -------
        tuple of Command
            What is to be done, in order; what concerns the course alone is done already. None if the notice
            was refused: then it is noted why, and nothing else has changed.

        Examples
        --------
        >>> from explicable.execution import prepare
        >>> from explicable.first_response import World, encode
        >>> course = Course(prepare(encode(World(("@*",)))))
        >>> course.apply(Notice(Event.PERSON_COMMANDED, ("command", "person", "c-0-1")), 0.0)
        (<Command.TAKE_PERSON_STEP: 'take person step'>,)
        >>> course.apply(Notice(Event.STEP_FINISHED, ("move", "r1", "c-0-0", "c-0-1")), 1.0)
        ()
        >>> course.occurrences[-1].refusal
        "'step finished' can't happen while 'deciding'"
        """
        self._time_s = time_s
        event, refusal = notice.event, object_to(self, notice)
        commands: tuple[Command, ...] = ()
        if not refusal:
            try:
                self.monitor, commands = react(self.monitor, event)
            except IllegalEventError as error:
                refusal = str(error)
            else:
                if event in _ENDS_OF_STEPS:
                    self._under_way.pop(self.agent_of(notice.action), None)
        for command in commands:
            effect = _EFFECTS.get(command)
            if effect is not None:
                effect(self, notice)
        self.occurrences.append(Occurrence(notice, time_s, self.monitor, self.state, refusal))
        return commands

    def _begin_step(self, notice: Notice) -> None:
        self._under_way[self.agent_of(notice.action)] = notice.action

    def _drop_agent(self, notice: Notice) -> None:
        """Do without an agent from now on; what became of its step is unknown."""
        if step := self._under_way.pop(notice.agent, ()):
            self._left_by[notice.agent] = step
        self.lost |= {notice.agent}
        self._begin_anew()

    def _take_agent_back(self, notice: Notice) -> None:
        """Reckon with an agent again, and with the step that it was about."""
        self.lost -= {notice.agent}
        if step := self._left_by.pop(notice.agent, ()):
            self._under_way[notice.agent] = step
        self._begin_anew()

    def _take_robot_step(self, notice: Notice) -> None:
        self._take(notice.action)
        self._last_robot_step = len(self.steps) - 1

    def _take_person_step(self, notice: Notice) -> None:
        predicted = next((step for step in self.plan if self.is_human(step)), None)
        if predicted is not None and predicted != notice.action:
            self.num_deviations += 1
            self.is_outdated = True
        self.num_changes += self.request is not None
        self._take(notice.action)

    def _take(self, action: GroundAtom) -> None:
        after = self.truth.after(self.state, action)
        if after is None:
            raise PlanError(f"{format_action(action)} can't be executed there")
        self._thought = self._thoughts.watch(self._thought, action, self.state, after)
        self.state = after
        self.steps.append(LabelledStep(self.setting.problem.agent_of(action).name, action, time=self._time_s))
        self._failures.clear()
        if self.plan and self.plan[0] == action:
            self.plan = self.plan[1:]
            return
        rest = list(self.plan)
        if action in rest:
            rest.remove(action)
        self.plan = tuple(rest) if self.leads_to_goal(rest) else ()

    def _take_facts(self, notice: Notice) -> None:
        truth, stage = self.truth, self.truth.stage
        known = [fact for fact in notice.facts if truth.task.holds(fact.atom, self.state) != fact.true]
        if not known:
            return
        self.state = change_state(stage, self.state, known)
        self.is_outdated, self.refused = True, frozenset()
        if truth.follow(self.state, self.plan) is None:
            self.plan = ()
        if all(fact.atom in stage.beliefs for fact in known):
            start = change_state(stage, self._start, known)
            if truth.follow(start, (step.action for step in self.steps[self._since :])) == self.state:
                self._problem, self._start = correct_model(self._problem, known), start
                return
        self._begin_anew()

    def _begin_anew(self) -> None:
        """Let the problem begin now: as it has become, it does not explain the past."""
        self._problem = self.problem_from_now
        self._since, self._start = len(self.steps), self.state

    def _record_answer(self, notice: Notice) -> None:
        number = self.asked_about(notice)
        if number is not None and notice.answer is not None:
            given = self.answers.setdefault(number, {})
            given[notice.agent] = notice.answer
            step = self.steps[number]
            self.steps[number] = LabelledStep(step.agent, step.action, all(given.values()), step.time)

    def _adopt_plan(self, notice: Notice) -> None:
        self.plan, self.is_outdated = notice.plan, False

    def _adopt_safe_plan(self, _: Notice) -> None:
        """Follow the last request by a shortest way; without one, wait, or do what needs no asking."""
        self.plan, self.is_outdated = (), False
        request = self.request
        if request is None:
            step = self.safe_step()
            self.plan = (step,) if step else ()
            return
        way = self.truth.fulfilment_way(self.state, request)
        if way is None:
            self.refused |= {request.action}
            self._thought = self._thoughts.give_up(self._thought, request)
        else:
            self.plan = tuple(self.truth.task.action(operator) for operator in way)

    def conclude(self, action: GroundAtom) -> tuple[Fact, ...]:
        """Return what a step's failing tells, the last time included: nothing, until it has failed thrice."""
        self._failures[action] = self._failures.get(action, 0) + 1
        fact = most_specific(self.truth.stage, action) if self._failures[action] >= _FAILURES else None
        return () if fact is None else (fact,)


_ENDS_OF_STEPS = frozenset((Event.STEP_FINISHED, Event.STEP_FAILED))
_EFFECTS: Mapping[Command, Callable[[Course, Notice], None]] = MappingProxyType(
    {
        Command.SEND_STEP: Course._begin_step,
        Command.ADOPT_PLAN: Course._adopt_plan,
        Command.ADOPT_SAFE_PLAN: Course._adopt_safe_plan,
        Command.TAKE_ROBOT_STEP: Course._take_robot_step,
        Command.TAKE_PERSON_STEP: Course._take_person_step,
        Command.TAKE_FACT: Course._take_facts,
        Command.DROP_AGENT: Course._drop_agent,
        Command.TAKE_AGENT_BACK: Course._take_agent_back,
        Command.RECORD_ANSWER: Course._record_answer,
    }
)

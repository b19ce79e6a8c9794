"""The course of a game: what has happened so far and what follows from it, without anything from outside.

`loop` brings events in and does outside what they lead to. Given the same notices, a course takes the same
states: so a game on record can be replayed.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from explicable.errors import PlanError, UsageError
from explicable.execution import mind as minds
from explicable.execution.episodes import Ending, follow
from explicable.execution.facts import change_state, correct_model, most_specific, restart_at, without
from explicable.execution.mind import Mind
from explicable.execution.monitor import FINAL, Command, Event, IllegalEventError, State, react
from explicable.execution.notices import Notice, Occurrence
from explicable.execution.objections import object_to
from explicable.execution.plans import Actions, Situation
from explicable.execution.robots.protocol import Fact
from explicable.execution.setting import Setting
from explicable.labelling.records import LabelledStep
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem

_FAILURES = 3
"""How often a step fails before it is put down to a fact."""


class Course:
    """A game under way; see the module.

    Parameters
    ----------
    setting
        Where it is played.
    at_once
        Whether several agents may be about steps at a time.

    Attributes
    ----------
    monitor
        State of the monitor.
    state
        Where the game stands, in the setting's truth.
    mind
        What a person may believe who has watched and learnt nothing else; knows the requests.
    plan
        What is left of the plan that the team follows.
    steps
        The steps done, with the answers given.
    num_deviations
        Steps of the person that were not the next predicted ones.
    num_changes
        Requests made while another was under way.
    refused
        Steps of the person that were of no use; what is found out may change that.
    lost
        Agents that are taken to do nothing any more.
    answers
        Who said of which steps (by number) whether they are explicable. The label of a step is whether all
        who answered found it so.
    """

    def __init__(self, setting: Setting, *, at_once: bool = False) -> None:
        self.setting, self.at_once = setting, at_once
        self.truth = setting.truth
        self.monitor = State.DECIDING
        self.state = self.truth.task.initial_state
        self.mind = Mind(setting.belief.task.initial_state)
        self.plan: Actions = ()
        self.steps: list[LabelledStep] = []
        self.occurrences: list[Occurrence] = []
        self.num_deviations = self.num_changes = 0
        self.refused: frozenset[GroundAtom] = frozenset()
        self.is_outdated = False
        self._problem, self._since, self._start = setting.problem, 0, self.state
        self._failures: dict[GroundAtom, int] = {}
        self.lost: frozenset[str] = frozenset()
        self.answers: dict[int, dict[str, bool]] = {}
        self._under_way: dict[str, GroundAtom] = {}  # by agent
        self._left_by: dict[str, GroundAtom] = {}  # what lost agents were about
        self._time_s = 0.0
        self._last_robot_step: int | None = None
        self._effects: dict[Command, Callable[[Notice], None]] = {
            Command.SEND_STEP: self._begin_step,
            Command.ADOPT_PLAN: self._adopt_plan,
            Command.ADOPT_SAFE_PLAN: self._adopt_safe_plan,
            Command.TAKE_ROBOT_STEP: self._take_robot_step,
            Command.TAKE_PERSON_STEP: self._take_person_step,
            Command.TAKE_FACT: self._take_facts,
            Command.DROP_AGENT: self._drop_agent,
            Command.TAKE_AGENT_BACK: self._take_agent_back,
            Command.RECORD_ANSWER: self._record_answer,
        }

    @property
    def situation(self) -> Situation:
        """What a plan would now be asked for."""
        past = tuple(step.action for step in self.steps[self._since :])
        announced = self.plan if self.leads_to_goal(self.plan) else ()
        return Situation(self._problem, past, announced, self.state, self.mind.request)

    @property
    def problem_from_now(self) -> TeamProblem:
        """The team problem that begins in the present state, without the agents that are lost."""
        truth, belief = self.truth.stage, self.setting.belief.stage
        problem = restart_at(self.setting.problem, truth, self.state, belief, self.mind.state)
        return without(problem, self.lost)

    @property
    def step_under_way(self) -> GroundAtom:
        """What the robot is about, in games in which one step is taken at a time; empty if it is not."""
        return () if self.at_once else next(iter(self._under_way.values()), ())

    @property
    def steps_under_way(self) -> Mapping[str, GroundAtom]:
        """What is being done, by agent."""
        return self._under_way

    @property
    def has_reached_goal(self) -> bool:
        """Whether the goal holds."""
        return self.truth.task.is_goal(self.state)

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
        self._time_s, refusal = time_s, object_to(self, notice)
        commands: tuple[Command, ...] = ()
        if not refusal:
            try:
                self.monitor, commands = react(self.monitor, notice.event)
            except IllegalEventError as error:
                refusal = str(error)
        if not refusal and notice.event in (Event.STEP_FINISHED, Event.STEP_FAILED):
            self._under_way.pop(self.agent_of(notice.action), None)
        for command in commands:
            if command in self._effects:
                self._effects[command](notice)
        self.occurrences.append(Occurrence(notice, time_s, self.monitor, self.state, refusal))
        return commands

    def allows(self, action: GroundAtom) -> bool:
        """Whether a step is possible now, by an agent that is not lost."""
        return self.truth.operator(self.state, action) is not None and not self._needs_lost((action,))

    def is_human(self, action: GroundAtom) -> bool:
        """Whether a step is a person's."""
        return self.setting.problem.agent_of(action).kind == "human"

    def is_step_of_person(self, action: GroundAtom) -> bool:
        """Whether a step is one that a person of this team could take."""
        return bool(action) and self.is_human(action) and bool(self.truth.task.operators_of(action))

    def is_news(self, facts: Iterable[Fact]) -> bool:
        """Whether not all of these facts were known, and they can be so."""
        try:
            return change_state(self.truth.stage, self.state, facts) != self.state
        except UsageError:
            return False

    def leads_to_goal(self, actions: Iterable[GroundAtom]) -> bool:
        """Whether steps are possible from here, without lost agents, and reach the goal."""
        actions = tuple(actions)
        state = self.truth.follow(self.state, actions)
        return state is not None and self.truth.task.is_goal(state) and not self._needs_lost(actions)

    def _needs_lost(self, actions: Actions) -> bool:
        """Tell whether a lost agent has a part in some steps."""
        return bool(self.lost) and any(self.agent_of(action) in self.lost for action in actions)

    def agent_of(self, action: GroundAtom) -> str:
        """Name the agent whose step it is."""
        return self.setting.problem.agent_of(action).name

    def safe_step(self) -> GroundAtom:
        """Return the robot's next step on a shortest way to what was last asked for; empty to wait."""
        return follow(self.truth, self.state, self.mind.request, "commanded") or ()

    def ending(self) -> Ending:
        """Say how the game has ended.

        Raises
        ------
        UsageError
            If it has not.
        """
        if self.monitor not in FINAL:
            raise UsageError("the game has not ended")
        if self.monitor is State.REACHED:
            return Ending.REACHED
        if self.monitor is State.ABORTED:
            return Ending.ABORTED
        last = self.occurrences[-1].notice
        return (
            Ending.IMPOSSIBLE if last.event is Event.NO_PLAN_EXISTS else Ending(last.reason or Ending.STUCK)
        )

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
        self.num_changes += self.mind.request is not None
        self._take(notice.action)

    def _take(self, action: GroundAtom) -> None:
        operator = self.truth.operator(self.state, action)
        if operator is None:
            raise PlanError(f"{format_action(action)} can't be executed there")
        after = self.truth.task.successor(self.state, operator)
        self.mind = minds.watch(self.setting, self.mind, action, self.state, after)
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
            self.steps[number] = replace(self.steps[number], label=all(given.values()))

    def asked_about(self, notice: Notice) -> int | None:
        """Return the number of the last robot step, if it is this one and has no answer of theirs yet."""
        number = self._last_robot_step
        if number is None or self.steps[number].action != notice.action:
            return None
        return None if notice.agent in self.answers.get(number, {}) else number

    def _adopt_plan(self, notice: Notice) -> None:
        self.plan, self.is_outdated = notice.plan, False

    def _adopt_safe_plan(self, _: Notice) -> None:
        """Follow the last request by a shortest way; without one, wait, or do what needs no asking."""
        self.plan, self.is_outdated = (), False
        request = self.mind.request
        if request is None:
            step = self.safe_step()
            self.plan = (step,) if step else ()
            return
        way = self.truth.fulfilment_way(self.state, request)
        if way is None:
            self.refused |= {request.action}
            self.mind = minds.give_up(self.mind, request)
        else:
            self.plan = tuple(self.truth.task.action(operator) for operator in way)

    def conclude(self, action: GroundAtom) -> tuple[Fact, ...]:
        """Return what a step's failing tells, the last time included: nothing, until it has failed thrice."""
        self._failures[action] = self._failures.get(action, 0) + 1
        fact = most_specific(self.truth.stage, action) if self._failures[action] >= _FAILURES else None
        return () if fact is None else (fact,)

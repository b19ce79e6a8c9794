"""How a game stands, and what can be asked about that; what changes it is the `course`."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.execution.episodes import Ending, follow
from explicable.execution.facts import change_state, restart_at, without
from explicable.execution.mind import Mind
from explicable.execution.monitor import FINAL, Event, State
from explicable.execution.notices import Notice, Occurrence
from explicable.execution.plans import Situation
from explicable.execution.robots.protocol import Fact
from explicable.execution.setting import Setting
from explicable.execution.thoughts import Thoughts
from explicable.model.plan import Actions
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request
from explicable.model.team import TeamProblem

if TYPE_CHECKING:
    from explicable.labelling.records import LabelledStep


class Position:
    """How a game stands.

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
        self._thoughts = setting.shared(Thoughts)
        self._thought = self._thoughts.first
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

    @property
    def mind(self) -> Mind:
        """What a person may believe who has watched and learnt nothing else; knows the requests."""
        return self._thought.mind

    @property
    def request(self) -> Request | None:
        """What was last asked for and not got."""
        return self._thought.request

    @property
    def situation(self) -> Situation:
        """What a plan would now be asked for."""
        past = tuple(step.action for step in self.steps[self._since :])
        announced = self.plan if self.leads_to_goal(self.plan) else ()
        return Situation(self._problem, past, announced, self.state, self.request)

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
        return self.truth.is_goal(self.state)

    def allows(self, action: GroundAtom) -> bool:
        """Whether a step is possible now, by an agent that is not lost."""
        return self.truth.step(self.state, action) is not None and not (
            self.lost and self._needs_lost((action,))
        )

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
        return state is not None and self.truth.is_goal(state) and not self._needs_lost(actions)

    def _needs_lost(self, actions: Actions) -> bool:
        """Tell whether a lost agent has a part in some steps."""
        return bool(self.lost) and any(self.agent_of(action) in self.lost for action in actions)

    def agent_of(self, action: GroundAtom) -> str:
        """Name the agent whose step it is."""
        return self.setting.problem.agent_of(action).name

    def safe_step(self) -> GroundAtom:
        """Return the robot's next step on a shortest way to what was last asked for; empty to wait."""
        return follow(self.truth, self.state, self.request, "commanded") or ()

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

    def asked_about(self, notice: Notice) -> int | None:
        """Return the number of the last robot step, if it is this one and has no answer of theirs yet."""
        number = self._last_robot_step
        if number is None or self.steps[number].action != notice.action:
            return None
        return None if notice.agent in self.answers.get(number, {}) else number

"""Live teaming: the robot follows a joint plan that predicts the person, and plans anew when that goes wrong.

The rules are those of the closed loop (`explicable.execution.run`), asked one step at a time, because between
two steps a page may be closed and a server started anew. Plans are only a memory: what is lost is made again.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from explicable.execution import Planner, Proposal, Setting, Situation
from explicable.execution.episodes import follow
from explicable.labelling import Labeller
from explicable.model.grounding import ground_team
from explicable.model.plan import Actions
from explicable.model.problem import GroundAtom
from explicable.search import Outcome, search

if TYPE_CHECKING:
    from explicable.model.requests import Request
    from explicable.model.task import State


_MOST_PLANS = 20_000


class LabelledPlanner:
    """Plans the rest of a game at least cost + alpha * expected inexplicable steps, given the past.

    Parameters
    ----------
    labeller
        What people find explicable.
    alpha
        Price of one inexplicable step, in the unit of cost.
    time_limit_s
        Seconds for the first plan, and as many for a better one.
    """

    def __init__(self, labeller: Labeller, alpha: float, time_limit_s: float) -> None:
        self.labeller, self.alpha, self.time_limit_s = labeller, alpha, time_limit_s

    def __call__(self, situation: Situation) -> Proposal:
        """Plan from here on."""
        team = ground_team(situation.problem)
        scorer = self.labeller.scorer(team, history=situation.past)
        start = team.task.execute(situation.past).states[-1]
        first, better = (
            search(
                team.task,
                algorithm,
                initial_state=start,
                scorer=scorer,
                alpha=self.alpha,
                time_limit_s=self.time_limit_s,
            )
            for algorithm in ("default", "anytime")
        )
        found = better if better.operators is not None else first
        return Proposal(found.outcome, tuple(map(team.task.action, found.operators or ())))


class Teaming:
    """Chooses a robot's steps by a joint plan; see `explicable.study.game.Next`.

    Parameters
    ----------
    setting
        The team problem, prepared for play.
    planner
        Makes the plans.
    """

    def __init__(self, setting: Setting, planner: Planner) -> None:
        self.setting, self.planner = setting, planner
        self._plans: dict[Actions, Actions] = {}

    def choose(self, state: "State", actions: Actions, request: "Request | None") -> GroundAtom | None:
        """Return the robot's next step; None where it waits for the person.

        Where the plan says that the person is next, it goes on with what was last asked for, if anything.
        """
        plan = self.plan(state, actions, request)
        if plan and not self._is_humans(plan[0]):
            return plan[0]
        return follow(self.setting.truth, state, request, "commanded")

    def expected(self, actions: Actions) -> GroundAtom | None:
        """Return what the person was last predicted to do next, as far as that is still known."""
        return next((step for step in self._plans.get(actions, ()) if self._is_humans(step)), None)

    def plan(self, state: "State", actions: Actions, request: "Request | None") -> Actions:
        """Return the plan from now on: what is left of the one announced, where that leads to the goal."""
        if actions not in self._plans:
            plan = self._next_plan(state, actions, request)
            if len(self._plans) >= _MOST_PLANS:
                self._plans.clear()
            self._plans[actions] = plan
        return self._plans[actions]

    def _next_plan(self, state: "State", actions: Actions, request: "Request | None") -> Actions:
        announced = self._plans.get(actions[:-1]) if actions else None
        left = list(announced or ())
        if left and actions[-1] in left:
            left.remove(actions[-1])
        if left and self._reaches_goal(state, left):
            return tuple(left)
        followed_orders = announced is not None and (not announced or self._is_humans(announced[0]))
        if followed_orders and request is not None and not self._is_humans(actions[-1]):
            return ()  # it goes on so: a new plan could lead the robot back and forth
        return self._planned(state, actions, request)

    def _planned(self, state: "State", actions: Actions, request: "Request | None") -> Actions:
        proposal = self.planner(Situation(self.setting.problem, actions, (), state, request))
        is_sound = proposal.outcome is Outcome.SOLVED and self._reaches_goal(state, proposal.actions)
        return proposal.actions if is_sound else ()

    def _reaches_goal(self, state: "State", plan: Sequence[GroundAtom]) -> bool:
        truth = self.setting.truth
        end = truth.follow(state, plan)
        return end is not None and truth.is_goal(end)

    def _is_humans(self, action: GroundAtom) -> bool:
        return self.setting.problem.agent_of(action).kind == "human"

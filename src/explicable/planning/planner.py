"""The explicable planner: the joint plan that is cheap *and* expected.

The paper's objective (Eq. 2 and 3) is ``J(plan) = cost(plan) + alpha * dist(plan)``, with the labels that a
labeller predicts for the plan in the place of the distance to the plan that the person expects. Its heuristic
(Eq. 4), for a path to a state and a relaxed plan ``rp`` from there, is

    h = (1 - F(L(path # rp))) * |path # rp| * |rp| + |rp|  =  (1 + c) * |rp|

where ``c`` is the number of inexplicable steps in ``path # rp``.
"""

import math
from dataclasses import dataclass

from explicable.errors import UsageError
from explicable.labelling import LabelledPlan, Labeller
from explicable.model.plan import JointPlan, Step
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamTask
from explicable.search import Outcome, SearchResult, search


@dataclass(frozen=True, slots=True)
class TeamPlan:
    """What planning for a team came to.

    Parameters
    ----------
    outcome
        Solved, proved unsolvable, or a limit was reached.
    plan
        The joint plan, if there is one.
    labelled
        The plan's steps with their predicted labels and all scores, if a labeller was given.
    evaluations
        Number of states for which the heuristic was computed.
    search_s
        Seconds spent in search.
    """

    outcome: Outcome
    plan: JointPlan | None
    labelled: LabelledPlan | None
    evaluations: int
    search_s: float


def plan_classically(
    team_task: TeamTask,
    *,
    labeller: Labeller | None = None,
    algorithm: str = "default",
    time_limit_s: float | None = None,
    seed: int = 0,
) -> TeamPlan:
    """Plan without regard to what the person expects; a labeller only scores the plan.

    Parameters
    ----------
    algorithm
        A search of `explicable.search.search`: ``"ff"`` is FF as published.
    """
    result = search(team_task.task, algorithm, time_limit_s=time_limit_s, seed=seed)
    return _team_plan(team_task, result, labeller)


def plan_explicably(
    team_task: TeamTask,
    labeller: Labeller,
    *,
    algorithm: str = "lazy",
    expected: bool = True,
    closing: str = "context",
    time_limit_s: float | None = None,
    seed: int = 0,
) -> TeamPlan:
    """Plan with Eq. 4, so that the steps are ones the person will find sensible.

    Parameters
    ----------
    algorithm
        ``"lazy"`` or ``"eager"`` best-first search by ``f = g + h``; ``"ff"``: enforced hill-climbing first,
        as in the paper.
    expected
        Count inexplicable steps by their expectation; False: by the most probable labels (Viterbi), as in the paper.
    closing
        ``"context"``: a state is closed together with the labeller's context; ``"state"``: alone, as in the paper.
    """
    result = search(
        team_task.task,
        algorithm,
        scorer=labeller.scorer(team_task, expected=expected),
        closing=closing,
        time_limit_s=time_limit_s,
        seed=seed,
    )
    return _team_plan(team_task, result, labeller)


def joint_plan(team_task: TeamTask, actions: tuple[GroundAtom, ...], cost: int) -> JointPlan:
    """Give each step of a plan its agent."""
    agent_of = team_task.problem.agent_of
    return JointPlan(tuple(Step(agent_of(action).name, action) for action in actions), cost)


def check_alpha(alpha: float) -> float:
    """Return ``alpha``, the price of one inexplicable step in the unit of cost.

    Raises
    ------
    UsageError
        If it is negative, infinite or not a number.
    """
    if not math.isfinite(alpha) or alpha < 0:
        raise UsageError(f"alpha must be a finite number of at least 0, not {alpha}")
    return alpha


def _team_plan(team_task: TeamTask, result: SearchResult, labeller: Labeller | None) -> TeamPlan:
    plan = labelled = None
    if result.operators is not None:
        actions = tuple(team_task.task.action(operator) for operator in result.operators)
        plan = joint_plan(team_task, actions, sum(map(team_task.task.cost, result.operators)))
        labelled = labeller.label(team_task, actions) if labeller else None
    return TeamPlan(result.outcome, plan, labelled, result.evaluations, result.search_s)

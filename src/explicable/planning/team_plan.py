"""What planning for a team comes to, and what it is worth.

The paper's objective (Eq. 2 and 3) is ``J(plan) = cost(plan) + alpha * dist(plan)``, with the labels that a
labeller predicts for the plan in the place of the distance to the plan that the person expects.
"""

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.plan import JointPlan, Step, format_action
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamTask
from explicable.search import Outcome, SearchResult

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller
    from explicable.labelling.features import TeamFeatures
    from explicable.planning.predictions import HumanModel, PredictedSteps


DEFAULT_ALPHA = 2.0
"""A step that the person doesn't understand is as bad as two steps more (docs/planning.md, *Which price*)."""


@dataclass(frozen=True, slots=True)
class TeamPlan:
    """What planning for a team came to.

    Parameters
    ----------
    outcome
        Solved if there is a plan; else proved unsolvable or limit reached; interrupted after Ctrl-C, with the
        best plan so far or none.
    plan
        The joint plan, if there is one.
    labelled
        The plan's steps with their predicted labels and all scores, if a labeller was given.
    objective
        ``J`` of the plan: its cost and, with regard to the person, ``alpha`` for each step expected to be
        inexplicable, and what is charged for human steps.
    lower_bound
        No plan has a lower objective; 0 if nothing is known.
    evaluations
        Number of states for which the heuristic was computed.
    search_s
        Seconds spent in search.
    alpha
        Price of one inexplicable step by which ``objective`` was reckoned.
    limit
        Which limit ended the search for a plan: ``"time"``, ``"memory"``, ``"evaluations"`` or None.
    predicted
        How plausible the plan's human steps are, if a model of the person's choices was given.
    """

    outcome: Outcome
    plan: JointPlan | None
    labelled: "LabelledPlan | None"
    objective: float | None
    lower_bound: float
    evaluations: int
    search_s: float
    alpha: float = 0.0
    limit: str | None = None
    predicted: "PredictedSteps | None" = None

    @property
    def explicability(self) -> float:
        """``E[F]`` of the plan; 1 for one without steps or labels."""
        if self.plan is None or self.labelled is None or not self.plan.steps:
            return 1.0
        return self.labelled.scores.f_expected or 0.0

    def _repr_html_(self) -> str:
        """Let a notebook show the plan: its steps, and how probably each is expected."""
        if self.plan is None:
            return f"<p>{self.outcome}</p>"
        steps = [f"{step.agent} {format_action(step.action)}" for step in self.plan.steps]
        if self.labelled:
            chances = zip(steps, self.labelled.probabilities, strict=True)
            steps = [f"{step}: expected with probability {p:.2f}" for step, p in chances]
        items = "".join(f"<li>{html.escape(step)}</li>" for step in steps)
        return f"<p>cost {self.plan.cost}</p><ol>{items}</ol>"


def joint_plan(team_task: TeamTask, actions: tuple[GroundAtom, ...], cost: int) -> JointPlan:
    """Give each step of a plan its agent."""
    agent_of = team_task.problem.agent_of
    return JointPlan(tuple(Step(agent_of(action).name, action) for action in actions), cost)


def plan_of(team_task: TeamTask, operators: Sequence[int]) -> JointPlan:
    """Make a joint plan of operators of the composite task."""
    task = team_task.task
    return joint_plan(team_task, tuple(map(task.action, operators)), sum(map(task.cost, operators)))


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


def best_plan(
    team_task: TeamTask,
    results: Sequence[SearchResult],
    labeller: "Labeller | None",
    alpha: float = 0.0,
    charged: "tuple[HumanModel, float] | None" = None,
    features: "TeamFeatures | None" = None,
) -> TeamPlan:
    """Choose the best of several searches' plans by ``J``.

    Parameters
    ----------
    results
        In the order of the searches: the last one's bound counts, and of plans with the same ``J`` its own.
        Nothing before a search that proved its plan best is looked at.
    labeller
        Labels the plans; without one ``J`` is the cost.
    alpha
        Price of one inexplicable step, in the unit of cost.
    charged
        What people choose, and the price, in the unit of cost, of a nat of surprise at what they have to do.
    features
        What the labeller sees of the task, if that was made before.
    """
    chosen: tuple[float, JointPlan, LabelledPlan | None, PredictedSteps | None] | None = None
    for result in reversed(results):
        if result.operators is not None:
            plan = plan_of(team_task, result.operators)
            labelled = labeller.label(features or team_task, plan.actions) if labeller else None
            value = objective(plan, labelled, alpha)
            predicted = None
            if charged is not None:
                human_model, weight = charged
                predicted = human_model.predict(team_task, plan.actions)
                value += weight * predicted.surprise if weight else 0.0
            if chosen is None or value < chosen[0]:
                chosen = (value, plan, labelled, predicted)
        if result.is_optimal:
            break
    best, found, labels, predicted = chosen or (None, None, None, None)
    return TeamPlan(
        outcome=_outcome(results, is_solved=found is not None),
        plan=found,
        labelled=labels,
        predicted=predicted,
        objective=best,
        lower_bound=results[-1].lower_bound if best is None else min(results[-1].lower_bound, best),
        evaluations=sum(result.evaluations for result in results),
        search_s=sum(result.search_s for result in results),
        alpha=alpha,
        limit=results[0].limit,
    )


def _outcome(results: Sequence[SearchResult], *, is_solved: bool) -> Outcome:
    if any(result.outcome is Outcome.INTERRUPTED for result in results):
        return Outcome.INTERRUPTED
    return Outcome.SOLVED if is_solved else results[0].outcome


def objective(plan: JointPlan, labelled: "LabelledPlan | None", alpha: float) -> float:
    """Return ``J = cost + alpha * E[number of inexplicable steps]`` (Eq. 3, its sign put right).

    Raises
    ------
    UsageError
        If alpha is negative, infinite or not a number.
    """
    check_alpha(alpha)
    if labelled is None or labelled.scores.f_expected is None:
        return plan.cost
    return plan.cost + alpha * len(plan) * (1.0 - labelled.scores.f_expected)

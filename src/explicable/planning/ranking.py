"""Re-ranking: plans from any planner in the order of the objective J."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.errors import PlanError
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamTask
from explicable.planning.team_plan import DEFAULT_ALPHA, check_alpha, joint_plan, objective

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller
    from explicable.labelling.features import TeamFeatures
    from explicable.planning.predictions import HumanModel, PredictedSteps


@dataclass(frozen=True, slots=True)
class RankedPlan:
    """One of several plans.

    Attributes
    ----------
    number
        Its place among the plans as they were given, from 0.
    actions
        Its steps.
    cost, objective, labelled
        As of `explicable.planning.TeamPlan`; None if it is no plan of the task.
    predicted
        How plausible its human steps are, if a model of the person's choices was given.
    objection
        Why it is none, or None.
    failing_step
        Number of the step that can't be executed, from 1, if that is why.
    """

    number: int
    actions: tuple[GroundAtom, ...]
    cost: int | None
    objective: float | None
    labelled: "LabelledPlan | None"
    predicted: "PredictedSteps | None"
    objection: str | None
    failing_step: int | None = None


def rank(
    team_task: TeamTask,
    labeller: "Labeller",
    plans: Iterable[Sequence[GroundAtom]],
    alpha: float = DEFAULT_ALPHA,
    *,
    human_model: "HumanModel | None" = None,
) -> list[RankedPlan]:
    """Order plans by ``J = cost + alpha * E[number of inexplicable steps]``, the best first.

    Equals keep the order in which they were given. What can't be executed in the composite task, or does not
    reach its goal, comes last, with the reason.

    Parameters
    ----------
    alpha
        Price of one inexplicable step, in the unit of cost.
    human_model
        Of the person's choices: says how plausible the human steps are. The order does not hang on it.

    Raises
    ------
    UsageError
        If alpha is negative, infinite or not a number.
    LabellerError
        If the labeller was trained on another domain.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.labelling.crf import ConditionalRandomField
    >>> from explicable.labelling.labeller import Labeller
    >>> from explicable.model.grounding import ground_team
    >>> weights = ["request: move farther"], [[-5.0, 0.0]], [[0, 0], [0, 0]]
    >>> labeller = Labeller(ConditionalRandomField.from_weights([True, False], *weights), schemas=["move"])
    >>> order = ("command", "person", "c-0-2")
    >>> way = [("move", "r1", "c-0-1", "c-0-2"), ("visit-room", "r1", "c-0-2")]
    >>> stray = [("move", "r1", "c-0-1", "c-0-0"), ("move", "r1", "c-0-0", "c-0-1")]
    >>> team_task = ground_team(encode(World((".@*",))))
    >>> ranked = rank(team_task, labeller, [[order, *stray, *way], [order, *way], way])
    >>> [plan.number for plan in ranked], ranked[-1].objection
    ([1, 0, 2], 'step 2, (visit-room r1 c-0-2), lacks (commanded c-0-2)')
    """
    check_alpha(alpha)
    features = labeller.features(team_task)
    ranked = [
        _judge(features, labeller, human_model, number, tuple(actions), alpha)
        for number, actions in enumerate(plans)
    ]
    return sorted(ranked, key=lambda plan: float("inf") if plan.objective is None else plan.objective)


def _judge(
    features: "TeamFeatures",
    labeller: "Labeller",
    human_model: "HumanModel | None",
    number: int,
    actions: tuple[GroundAtom, ...],
    alpha: float,
) -> RankedPlan:
    team_task = features.team
    try:
        execution = team_task.task.execute(actions)
    except PlanError as error:
        return RankedPlan(number, actions, None, None, None, None, error.message, error.step)
    if not team_task.task.is_goal(execution.states[-1]):
        return RankedPlan(number, actions, None, None, None, None, "the plan does not reach the goal")
    labelled = labeller.label(features, actions)
    value = objective(joint_plan(team_task, actions, execution.cost), labelled, alpha)
    predicted = human_model.predict(features, actions) if human_model else None
    return RankedPlan(number, actions, execution.cost, value, labelled, predicted, None)

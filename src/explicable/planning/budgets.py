"""Budgets in the place of alpha: at most so much dearer, or at least so explicable."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.team import TeamTask
from explicable.planning.pareto import ROUNDING, FrontPlan, explore
from explicable.planning.planner import TeamPlan
from explicable.search import Outcome

if TYPE_CHECKING:
    from explicable.labelling import Labeller


def plan_within_budget(
    team_task: TeamTask,
    labeller: "Labeller",
    *,
    max_cost_increase: float | None = None,
    min_explicability: float | None = None,
    max_alpha: float = 10.0,
    search_s: float = 1.0,
    time_limit_s: float | None = None,
    seed: int = 0,
) -> TeamPlan:
    """Plan explicably with a budget in the place of alpha: `front`, then `choose`.

    Parameters
    ----------
    max_cost_increase, min_explicability
        As of `choose`: 0.1 for at most 10 % dearer than the cheapest, 0.9 for an expected F of at least 0.9.
    max_alpha, search_s, time_limit_s
        As of `front`.

    Returns
    -------
    TeamPlan
        Its ``alpha`` is the least at which the plan is best. If no plan keeps to the budget, ``plan`` is None
        and ``outcome`` is that of the search for any plan, or "limit reached".

    Raises
    ------
    UsageError
        As `front` and `choose`.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.labelling.crf import ConditionalRandomField
    >>> from explicable.labelling.labeller import Labeller
    >>> from explicable.model.grounding import ground_team
    >>> weights = ["step: move"], [[-5.0, 0.0]], [[0, 0], [0, 0]]
    >>> labeller = Labeller(ConditionalRandomField.from_weights([True, False], *weights), schemas=["move"])
    >>> plan_within_budget(ground_team(encode(World((".@*",)))), labeller, max_cost_increase=0.1).plan.cost
    3
    """
    choose((), max_cost_increase=max_cost_increase, min_explicability=min_explicability)  # refused at once
    pool = explore(team_task, labeller, max_alpha, search_s, time_limit_s, seed)
    plans = pool.front()
    chosen = choose(plans, max_cost_increase=max_cost_increase, min_explicability=min_explicability)
    if chosen is None:
        outcome = Outcome.LIMIT if plans else pool.outcome
        return TeamPlan(outcome, None, None, None, 0.0, pool.evaluations, pool.search_s)
    objective = chosen.value(chosen.alpha_from)
    return TeamPlan(
        outcome=pool.outcome if pool.outcome is Outcome.INTERRUPTED else Outcome.SOLVED,
        plan=chosen.plan,
        labelled=chosen.labelled,
        objective=objective,
        lower_bound=objective if chosen.is_proved else 0.0,
        evaluations=pool.evaluations,
        search_s=pool.search_s,
        alpha=chosen.alpha_from,
    )


def choose(
    plans: Sequence[FrontPlan],
    *,
    max_cost_increase: float | None = None,
    min_explicability: float | None = None,
) -> FrontPlan | None:
    """Choose from a front by a budget instead of an alpha.

    Only plans of the front are chosen from; others, best at no alpha, may use the budget up more closely.

    Parameters
    ----------
    max_cost_increase
        The most explicable plan is wanted that exceeds the cheapest by no more than this share of its cost.
    min_explicability
        The plan must have an expected ``F`` of at least this; alone, the cheapest such plan is wanted.

    Returns
    -------
    FrontPlan or None
        None if no plan of the front keeps to the budget.

    Raises
    ------
    UsageError
        If neither is given, or one is out of range.
    """
    if max_cost_increase is None and min_explicability is None:
        raise UsageError("a budget is needed: of cost or of explicability")
    if max_cost_increase is not None and not 0 <= max_cost_increase < math.inf:
        raise UsageError(f"the cost can't be allowed to increase by {max_cost_increase}")
    if min_explicability is not None and not 0 <= min_explicability <= 1:
        raise UsageError(f"explicability is from 0 to 1, not {min_explicability}")
    fitting = [found for found in plans if found.explicability >= (min_explicability or 0.0)]
    if max_cost_increase is None:
        return min(fitting, key=lambda found: found.plan.cost, default=None)
    limit = (1 + max_cost_increase) * min((found.plan.cost for found in plans), default=0) + ROUNDING
    return max(
        (found for found in fitting if found.plan.cost <= limit),
        key=lambda found: -found.num_inexplicable,
        default=None,
    )

"""Budgets in the place of alpha: at most so much dearer, or at least so explicable."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.team import TeamTask
from explicable.planning.affordable import plan_most_explicably
from explicable.planning.deadline import Deadline
from explicable.planning.pareto import ROUNDING, FrontPlan
from explicable.planning.planner import plan_classically
from explicable.planning.team_plan import TeamPlan
from explicable.search import Outcome, held_interrupt

if TYPE_CHECKING:
    from explicable.labelling import Labeller


@held_interrupt()
def plan_within_budget(
    team_task: TeamTask,
    labeller: "Labeller",
    *,
    max_cost_increase: float | None = None,
    min_explicability: float | None = None,
    search_s: float = 1.0,
    time_limit_s: float | None = None,
    max_evaluations: int | None = None,
    seed: int = 0,
) -> TeamPlan:
    """Plan explicably with a budget in the place of alpha.

    Parameters
    ----------
    max_cost_increase
        0.1: the most explicable plan that is at most 10 % dearer than the cheapest.
    min_explicability
        0.9: the plan must have an expected ``F`` of at least 0.9; alone, the smallest limit of cost is sought
        within which the most explicable plan has it, by bisection.
    search_s
        Seconds for each search, of which there are two with a limit of cost, else some more.
    time_limit_s
        Seconds for all of them.
    max_evaluations
        Heuristic values for each plan sought.

    Returns
    -------
    TeamPlan
        The most explicable plan within the limit of cost, its objective as of `plan_most_explicably`; if that
        is also the lower bound, the plan is proved to be the right one (with `min_explicability` alone: to be
        the most explicable at its cost). If no plan keeps to the budget, ``plan`` is None and ``outcome`` is
        that of the search for any plan, or "limit reached".

    Raises
    ------
    UsageError
        As `choose`.

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
    _check_budget(max_cost_increase, min_explicability)
    deadline = Deadline.after(time_limit_s)
    features = labeller.features(team_task)
    searches: list[TeamPlan] = []

    def solve(max_cost: int | None) -> TeamPlan:
        searches.append(
            plan_most_explicably(
                features,
                labeller,
                max_cost,
                improve_s=search_s,
                time_limit_s=deadline.limit_s,
                max_evaluations=max_evaluations,
                seed=seed,
            )
        )
        return searches[-1]

    cheapest = plan_classically(
        team_task,
        labeller=labeller,
        algorithm="anytime",
        time_limit_s=min(search_s, deadline.left_s),
        max_evaluations=max_evaluations,
        seed=seed,
    )
    searches.append(cheapest)
    if cheapest.plan is None:
        return cheapest
    if max_cost_increase is not None:
        chosen = solve(math.floor((1 + max_cost_increase) * cheapest.plan.cost + ROUNDING))
    else:
        chosen = _cheapest_of(solve, cheapest.plan.cost, min_explicability or 0.0, deadline)
    if chosen.plan is None or chosen.explicability < (min_explicability or 0.0):
        chosen = replace(chosen, outcome=Outcome.LIMIT, plan=None, labelled=None, objective=None)
    return _with_effort(chosen, searches)


def _check_budget(max_cost_increase: float | None, min_explicability: float | None) -> None:
    if max_cost_increase is None and min_explicability is None:
        raise UsageError("a budget is needed: of cost or of explicability")
    if max_cost_increase is not None and not 0 <= max_cost_increase < math.inf:
        raise UsageError(f"the cost can't be allowed to increase by {max_cost_increase}")
    if min_explicability is not None and not 0 <= min_explicability <= 1:
        raise UsageError(f"explicability is from 0 to 1, not {min_explicability}")


def _cheapest_of(
    solve: Callable[[int | None], TeamPlan],
    cheapest: int,
    min_explicability: float,
    deadline: Deadline,
) -> TeamPlan:
    """Bisect for the smallest limit of cost within which the most explicable plan is explicable enough."""
    best = solve(None)
    low = cheapest
    while (
        best.plan is not None
        and best.explicability >= min_explicability
        and low < best.plan.cost
        and best.outcome is not Outcome.INTERRUPTED
        and deadline.left_s > 0
    ):
        limit = (low + best.plan.cost - 1) // 2
        found = solve(limit)
        if found.plan is not None and found.explicability >= min_explicability:
            best = found
        else:
            low = limit + 1
    return best


def _with_effort(chosen: TeamPlan, searches: Sequence[TeamPlan]) -> TeamPlan:
    """Return a plan with what all searches took together; interrupted if one of them was."""
    interrupted = any(found.outcome is Outcome.INTERRUPTED for found in searches)
    return replace(
        chosen,
        outcome=Outcome.INTERRUPTED if interrupted else chosen.outcome,
        evaluations=sum(found.evaluations for found in searches),
        search_s=sum(found.search_s for found in searches),
    )


def choose(
    plans: Sequence[FrontPlan],
    *,
    max_cost_increase: float | None = None,
    min_explicability: float | None = None,
) -> FrontPlan | None:
    """Choose from a front by a budget instead of an alpha.

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
    _check_budget(max_cost_increase, min_explicability)
    fitting = [found for found in plans if found.explicability >= (min_explicability or 0.0)]
    if max_cost_increase is None:
        return min(fitting, key=lambda found: found.plan.cost, default=None)
    limit = (1 + max_cost_increase) * min((found.plan.cost for found in plans), default=0) + ROUNDING
    return max(
        (found for found in fitting if found.plan.cost <= limit),
        key=lambda found: -found.num_inexplicable,
        default=None,
    )

"""The front of cost and explicability: which plans are best at some price of an inexplicable step.

``J = cost + alpha * E[number of inexplicable steps]`` is linear in both, so its least plans over all alpha
are the corners of the lower convex hull of all plans. They are found corner by corner: the alpha at which two
neighbours have the same ``J`` either shows a plan that is better than both there, or that there is none
between them (Aneja & Nair, "Bicriteria transportation problem", Management Science 25, 1979).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.plan import JointPlan
from explicable.model.team import TeamTask
from explicable.planning.planner import check_alpha, plan_explicably

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller

SMALLEST_ALPHA = 1e-4
"""Stands for 0: so that of all cheapest plans the most explicable is taken."""

_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True)
class FrontPlan:
    """A plan that is best from one alpha to another.

    Attributes
    ----------
    plan
        The joint plan.
    labelled
        Its steps with their predicted labels and all scores.
    num_inexplicable
        Expected number of inexplicable steps.
    alpha_from, alpha_to
        Where it is best, in the unit of cost; the last plan's end is infinite, though no alpha above the
        largest was looked at.
    is_proved
        Whether it is proved that no plan is better at the alpha at which it was found.
    """

    plan: JointPlan
    labelled: "LabelledPlan"
    num_inexplicable: float
    alpha_from: float
    alpha_to: float
    is_proved: bool

    @property
    def explicability(self) -> float:
        """``E[F]``, the expected share of explicable steps; 1 for a plan without steps."""
        return 1.0 - self.num_inexplicable / max(len(self.plan), 1)


def front(
    team_task: TeamTask,
    labeller: "Labeller",
    *,
    max_alpha: float = 10.0,
    search_s: float = 1.0,
    seed: int = 0,
) -> tuple[FrontPlan, ...]:
    """Find all plans that have the least ``J`` for some alpha from 0 to `max_alpha`, the cheapest first.

    Parameters
    ----------
    max_alpha
        The largest price of an inexplicable step to look at, in the unit of cost.
    search_s
        Seconds for each of the searches, of which there are about two a plan.

    Returns
    -------
    tuple of FrontPlan
        Costs rise and expected numbers of inexplicable steps fall; empty if no plan was found.

    Raises
    ------
    UsageError
        If `max_alpha` is not finite, or below `SMALLEST_ALPHA`.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.labelling.crf import ConditionalRandomField
    >>> from explicable.labelling.labeller import Labeller
    >>> from explicable.model.grounding import ground_team
    >>> weights = ["step: move"], [[-5.0, 0.0]], [[0, 0], [0, 0]]
    >>> labeller = Labeller(ConditionalRandomField.from_weights([True, False], *weights), schemas=["move"])
    >>> [(found.plan.cost, found.alpha_to) for found in front(ground_team(encode(World((".@*",)))), labeller)]
    [(3, inf)]
    """
    if check_alpha(max_alpha) < SMALLEST_ALPHA:
        raise UsageError(f"the largest alpha must be at least {SMALLEST_ALPHA}, not {max_alpha}")

    def solve(alpha: float) -> FrontPlan | None:
        found = plan_explicably(team_task, labeller, alpha=alpha, improve_s=search_s, seed=seed)
        if found.plan is None or found.labelled is None or found.objective is None:
            return None
        count = (
            len(found.plan) * (1.0 - (found.labelled.scores.f_expected or 0.0)) if found.plan.steps else 0.0
        )
        is_proved = found.objective - found.lower_bound <= _ROUNDING * found.objective
        return FrontPlan(found.plan, found.labelled, count, 0.0, math.inf, is_proved)

    cheapest, dearest = solve(SMALLEST_ALPHA), solve(max_alpha)
    if cheapest is None or dearest is None:
        return ()
    corners = [cheapest]
    pending = [dearest]  # the next corner, or one further on
    while pending:
        left, right = corners[-1], pending[-1]
        if right.plan.cost <= left.plan.cost or right.num_inexplicable >= left.num_inexplicable - _ROUNDING:
            pending.pop()  # no other corner, or one that a search out of time left worse
            continue
        alpha = _even(left, right)
        between = solve(alpha)
        if between is not None and _value(between, alpha) < _value(left, alpha) - _ROUNDING:
            pending.append(between)
        else:
            corners.append(pending.pop())
    return _with_ranges(corners)


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
    limit = (1 + max_cost_increase) * min((found.plan.cost for found in plans), default=0) + _ROUNDING
    return max(
        (found for found in fitting if found.plan.cost <= limit),
        key=lambda found: -found.num_inexplicable,
        default=None,
    )


def _value(found: FrontPlan, alpha: float) -> float:
    return found.plan.cost + alpha * found.num_inexplicable


def _even(left: FrontPlan, right: FrontPlan) -> float:
    """Return the alpha at which both have the same ``J``."""
    return (right.plan.cost - left.plan.cost) / (left.num_inexplicable - right.num_inexplicable)


def _with_ranges(corners: list[FrontPlan]) -> tuple[FrontPlan, ...]:
    changes = [_even(left, right) for left, right in pairwise(corners)]
    limits = [0.0, *changes, math.inf]
    return tuple(
        replace(corner, alpha_from=limits[number], alpha_to=limits[number + 1])
        for number, corner in enumerate(corners)
    )

"""The front of cost and explicability: which plans are best at some price of an inexplicable step.

``J = cost + alpha * E[number of inexplicable steps]`` is linear in both, so its least plans over all alpha
are the corners of the lower convex hull of all plans. They are found corner by corner: the alpha at which two
neighbours have the same ``J`` either shows a plan that is better than both there, or that there is none
between them (Aneja & Nair, "Bicriteria transportation problem", Management Science 25, 1979).
"""

import math
import time
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.plan import JointPlan
from explicable.model.team import TeamTask
from explicable.planning.planner import TeamPlan, check_alpha, plan_classically, plan_explicably
from explicable.search import Outcome, held_interrupt

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller
    from explicable.model.problem import GroundAtom

SMALLEST_ALPHA = 1e-4
"""Stands for 0: so that of all cheapest plans the most explicable is taken."""

ROUNDING = 1e-6


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
        Whether it is proved that nowhere in that range a plan is better, up to the largest alpha that was
        looked at. If all are, the front is complete.
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

    def value(self, alpha: float) -> float:
        """``J`` at an alpha."""
        return self.plan.cost + alpha * self.num_inexplicable


def front(
    team_task: TeamTask,
    labeller: "Labeller",
    *,
    max_alpha: float = 10.0,
    search_s: float = 1.0,
    time_limit_s: float | None = None,
    seed: int = 0,
) -> tuple[FrontPlan, ...]:
    """Find all plans that have the least ``J`` for some alpha from 0 to `max_alpha`, the cheapest first.

    Parameters
    ----------
    max_alpha
        The largest price of an inexplicable step to look at, in the unit of cost.
    search_s
        Seconds for each of the searches, of which there are about two a plan.
    time_limit_s
        Seconds for all of them; what is found by then is given.

    Returns
    -------
    tuple of FrontPlan
        Costs rise and expected numbers of inexplicable steps fall; empty if no plan was found. After Ctrl-C
        what was found by then.

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
    pool = explore(team_task, labeller, max_alpha, search_s, time_limit_s, seed)
    if pool.outcome is Outcome.INTERRUPTED and not pool.has_plan:
        raise KeyboardInterrupt
    return pool.front()


@held_interrupt()
def explore(
    team_task: TeamTask,
    labeller: "Labeller",
    max_alpha: float,
    search_s: float,
    time_limit_s: float | None,
    seed: int,
) -> "Pool":
    """Look for plans at the alphas at which the front may have another corner; parameters as of `front`."""
    if check_alpha(max_alpha) < SMALLEST_ALPHA:
        raise UsageError(f"the largest alpha must be at least {SMALLEST_ALPHA}, not {max_alpha}")
    deadline = math.inf if time_limit_s is None else time.monotonic() + time_limit_s
    pool = Pool()

    def left_s() -> float:
        return max(0.0, deadline - time.monotonic())

    def solve(alpha: float) -> None:
        limit_s = None if deadline == math.inf else left_s()
        pool.add(
            plan_explicably(
                team_task, labeller, alpha=alpha, improve_s=search_s, time_limit_s=limit_s, seed=seed
            ),
            alpha,
        )

    cheapest_s = min(search_s, left_s())
    pool.add(
        plan_classically(
            team_task, labeller=labeller, algorithm="anytime", time_limit_s=cheapest_s, seed=seed
        )
    )
    alphas = [SMALLEST_ALPHA, max_alpha]
    while alphas and pool.outcome is not Outcome.INTERRUPTED and (left_s() > 0 or not pool.has_plan):
        solve(alphas[0])
        alphas = alphas[1:] if alphas[0] == SMALLEST_ALPHA else pool.unsettled(max_alpha)
    return pool


class Pool:
    """All plans found so far, and what is proved of each alpha that was looked at."""

    def __init__(self) -> None:
        self.outcome = Outcome.LIMIT
        self.evaluations = 0
        self.search_s = 0.0
        self._plans: dict[tuple[GroundAtom, ...], FrontPlan] = {}
        self._bounds: dict[float, float] = {}  # by alpha

    def add(self, found: TeamPlan, alpha: float | None = None) -> None:
        """Take a search's plan and its bound of J at an alpha; without one nothing is known of J."""
        self.outcome = found.outcome
        self.evaluations += found.evaluations
        self.search_s += found.search_s
        if alpha is not None:
            self._bounds[alpha] = found.lower_bound
        if found.plan is not None and found.labelled is not None:
            share = 1.0 if not found.plan.steps else found.labelled.scores.f_expected or 0.0
            count = len(found.plan) * (1.0 - share)
            self._plans[found.plan.actions] = FrontPlan(
                found.plan, found.labelled, count, 0.0, math.inf, is_proved=False
            )

    @property
    def has_plan(self) -> bool:
        """Whether there is any plan."""
        return bool(self._plans)

    def unsettled(self, max_alpha: float) -> list[float]:
        """List the alphas at which two neighbours on the front are even, and which were not looked at."""
        alphas = [even(left, right) for left, right in pairwise(self._corners())]
        return [alpha for alpha in alphas if alpha <= max_alpha and alpha not in self._bounds]

    def front(self) -> tuple[FrontPlan, ...]:
        """Give the corners with the alphas at which they are best."""
        corners = self._corners()
        if not corners:
            return ()
        limits = [0.0, *(even(left, right) for left, right in pairwise(corners)), math.inf]
        return tuple(
            replace(
                corner, alpha_from=lowest, alpha_to=highest, is_proved=self._is_best(corner, lowest, highest)
            )
            for corner, (lowest, highest) in zip(corners, pairwise(limits), strict=True)
        )

    def _is_best(self, corner: FrontPlan, lowest: float, highest: float) -> bool:
        """Tell whether a plan is proved best at both ends of a range, as far as that was looked at.

        The least J is concave in alpha and at most that of the plan, so what holds at the ends holds between.
        """
        if not self._bounds:
            return False
        ends = (max(lowest, min(self._bounds)), min(highest, max(self._bounds)))
        return all(corner.value(end) <= self._bounds.get(end, -math.inf) + ROUNDING for end in ends)

    def _corners(self) -> list[FrontPlan]:
        """Give the lower convex hull of the plans, the cheapest first (Andrew's monotone chain)."""
        corners: list[FrontPlan] = []
        for found in sorted(self._plans.values(), key=lambda one: (one.plan.cost, one.num_inexplicable)):
            if corners and found.num_inexplicable >= corners[-1].num_inexplicable - ROUNDING:
                continue
            while len(corners) > 1 and even(corners[-1], found) <= even(*corners[-2:]):
                corners.pop()
            corners.append(found)
        return corners


def even(left: FrontPlan, right: FrontPlan) -> float:
    """Return the alpha at which a plan and a dearer, more explicable one have the same ``J``."""
    return (right.plan.cost - left.plan.cost) / (left.num_inexplicable - right.num_inexplicable)

"""The front of cost and explicability: the plans to which no other is preferable in both.

``J = cost + alpha * E[number of inexplicable steps]`` is linear in both, so its least plans over all alpha
are the corners of the lower convex hull of all plans; `explicable.planning.exploration` searches for them.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

from explicable.model.plan import JointPlan
from explicable.planning.team_plan import TeamPlan
from explicable.search import Outcome

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan
    from explicable.model.problem import GroundAtom

ROUNDING = 1e-6


@dataclass(frozen=True, slots=True)
class FrontPlan:
    """A plan to which no other is preferable both in cost and in explicability.

    Attributes
    ----------
    plan
        The joint plan.
    labelled
        Its steps with their predicted labels and all scores.
    num_inexplicable
        Expected number of inexplicable steps.
    alpha_from, alpha_to
        Where it has the least ``J``, in the unit of cost; the last plan's end is infinite, though no alpha
        above the largest was looked at. None of both for a plan between two corners, which has it nowhere.
    is_proved
        Whether it is proved that nowhere in that range a plan is better, up to the largest alpha that was
        looked at; of a plan between corners, that none as cheap is more explicable. If all are, the front is
        complete.
    """

    plan: JointPlan
    labelled: "LabelledPlan"
    num_inexplicable: float
    alpha_from: float | None
    alpha_to: float | None
    is_proved: bool

    @property
    def explicability(self) -> float:
        """``E[F]``, the expected share of explicable steps; 1 for a plan without steps."""
        return 1.0 - self.num_inexplicable / max(len(self.plan), 1)

    def value(self, alpha: float) -> float:
        """``J`` at an alpha."""
        return self.plan.cost + alpha * self.num_inexplicable


class Front(tuple[FrontPlan, ...]):
    """The plans of a front, the cheapest first: a tuple that shows itself in a notebook."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        """Let a notebook show what each plan costs, and how explicable it is."""
        rows = "".join(
            f"<tr><td>{found.plan.cost}</td><td>{found.num_inexplicable:.2f}</td><td>{found.explicability:.3f}"
            f' <meter min="0" max="1" value="{found.explicability:.3f}"></meter></td></tr>'
            for found in self
        )
        return f"<table><tr><th>cost</th><th>inexplicable steps</th><th>E[F]</th></tr>{rows}</table>"


class Pool:
    """All plans found so far, and what is proved of each alpha that was looked at."""

    def __init__(self) -> None:
        self.outcome = Outcome.LIMIT
        self._plans: dict[tuple[GroundAtom, ...], FrontPlan] = {}
        self._bounds: dict[float, float] = {}  # by alpha
        self._most_explicable: dict[int, FrontPlan | None] = {}  # by limit of cost

    def add(self, found: TeamPlan, alpha: float | None = None) -> None:
        """Take a search's plan and its bound of J at an alpha; without one nothing is known of J."""
        self._note_outcome(found)
        if alpha is not None:
            self._bounds[alpha] = found.lower_bound
        plan = _front_plan(found)
        if plan is not None:
            self._plans[plan.plan.actions] = plan

    def add_within(self, max_cost: int, found: TeamPlan) -> None:
        """Take the plan found to be the most explicable of at most some cost."""
        self._note_outcome(found)
        plan = self._most_explicable[max_cost] = _front_plan(found)
        if plan is not None:
            self._plans[plan.plan.actions] = plan  # a corner after all, where corners are not proved

    def _note_outcome(self, found: TeamPlan) -> None:
        # Without an affordable plan in time, what was found before is still there.
        self.outcome = found.outcome if found.plan or not self._plans else Outcome.SOLVED

    @property
    def has_plan(self) -> bool:
        """Whether there is any plan."""
        return bool(self._plans)

    def unsettled(self, max_alpha: float) -> list[float]:
        """List the alphas at which two neighbours on the front are even, and which were not looked at."""
        alphas = [even(left, right) for left, right in pairwise(self._corners())]
        return [alpha for alpha in alphas if alpha <= max_alpha and alpha not in self._bounds]

    def next_limit(self) -> int | None:
        """Give the greatest cost within which the most explicable plan is still to be looked for."""
        for left, right in pairwise(self._corners()):
            limit = right.plan.cost - 1
            while limit > left.plan.cost and limit in self._most_explicable:
                found = self._most_explicable[limit]
                limit = left.plan.cost
                if found is not None and _is_between(left, found, right):
                    limit = found.plan.cost - 1
            if limit > left.plan.cost:
                return limit
        return None

    def front(self) -> Front:
        """Give the corners with the alphas at which they are best, and the plans between them."""
        corners = self._ranged_corners()
        between = {
            found.plan.cost: found
            for found in self._most_explicable.values()
            if found is not None and any(_is_between(left, found, right) for left, right in pairwise(corners))
        }
        return Front(sorted((*corners, *between.values()), key=lambda found: found.plan.cost))

    def _ranged_corners(self) -> tuple[FrontPlan, ...]:
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


def _front_plan(found: TeamPlan) -> FrontPlan | None:
    """Make of a search's plan one whose place on the front is not known yet."""
    if found.plan is None or found.labelled is None:
        return None
    is_best = found.objective is not None and found.lower_bound >= found.objective * (1 - ROUNDING)
    return FrontPlan(
        found.plan,
        found.labelled,
        len(found.plan) * (1.0 - found.explicability),
        None,
        None,
        is_proved=is_best,
    )


def _is_between(left: FrontPlan, found: FrontPlan, right: FrontPlan) -> bool:
    """Tell whether a plan is dearer and more explicable than one corner, and less so than the next."""
    return (
        left.plan.cost < found.plan.cost < right.plan.cost
        and left.num_inexplicable - ROUNDING > found.num_inexplicable > right.num_inexplicable + ROUNDING
    )


def even(left: FrontPlan, right: FrontPlan) -> float:
    """Return the alpha at which a plan and a dearer, more explicable one have the same ``J``."""
    return (right.plan.cost - left.plan.cost) / (left.num_inexplicable - right.num_inexplicable)

"""Conform or explain: plan as the person expects, or tell them something first, whichever is cheaper.

Balancing the two in one objective follows Chakraborti, Sreedharan & Kambhampati, "Balancing explicability and
explanations in human-aware planning" (IJCAI 2019), with the labeller in the place of optimality. The labels
of a plan hang on the whole path and the mental model together, so telling is weighed plan by plan, not inside
the search:

    J(plan, told, t) = cost(plan) + alpha * E[number of inexplicable steps] + telling_cost * |told|,

where steps before t are labelled under the mental model as it was, the others under the corrected one.
"""

import itertools
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.plan import JointPlan
from explicable.model.team import TeamTask
from explicable.planning.differences import Difference, find_differences
from explicable.planning.explanation import explain, tell
from explicable.planning.planner import check_alpha, joint_plan, plan_explicably
from explicable.search import Outcome, search

if TYPE_CHECKING:
    from explicable.labelling import Labeller

_AS_GOOD = 1e-9  # differences in an expected number of steps that are but rounding


@dataclass(frozen=True, slots=True)
class ToldPlan:
    """A plan, and what the person is told in the course of it.

    Attributes
    ----------
    outcome
        Solved if there is a plan; else why there is none.
    plan
        The joint plan; telling is none of its steps.
    told
        What the person is told; empty if conforming is cheaper.
    before_step
        The person is told right before this step, counted from 0; None if nothing is told.
    probabilities
        Of each step: that it is expected, given what the person knows by then.
    objective
        J, telling included.
    objective_untold
        J of the best plan found without telling.
    is_complete
        Whether all sets up to the size allowed were tried, but for those that cost too much by themselves.
    """

    outcome: Outcome
    plan: JointPlan | None
    told: tuple[Difference, ...]
    before_step: int | None
    probabilities: tuple[float, ...]
    objective: float | None
    objective_untold: float | None
    is_complete: bool


def conform_or_explain(
    team_task: TeamTask,
    labeller: "Labeller",
    *,
    alpha: float = 1.0,
    telling_cost: float = 1.0,
    max_told: int = 2,
    improve_s: float = 0.2,
    time_limit_s: float = 10.0,
    seed: int = 0,
) -> ToldPlan:
    """Find the cheapest of plans that conform to what the person expects, or that come with an explanation.

    Plans without telling come first: the best explicable one and the cheapest. Then sets of differences
    between the two models are tried: those that explain the unexpected steps of these plans, one by one and
    all together, whatever their size; then all others in the order of size up to ``max_told``. For each set a
    plan is made for the person so corrected, and that plan, with and without telling, and those before are
    weighed. A set is left out if its telling alone, with the least that any plan costs, is no better than
    what was found.

    Everything is told at one time, the latest that makes J no worse. What is returned is the best of what was
    tried: `is_complete` does not mean that no better plan exists for a set that was tried.

    Parameters
    ----------
    alpha
        Price of one inexplicable step, in the unit of cost.
    telling_cost
        Price of telling one difference, in the unit of cost.
    max_told
        Largest set of differences, but for sets that explain a plan.
    improve_s
        Seconds for the improvement of each plan.
    time_limit_s
        Seconds after which no further set is tried.
    seed
        Of the searches.

    Raises
    ------
    UsageError
        If a price is negative, infinite or not a number, or the size is negative.
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
    >>> team_task = ground_team(encode(World(("@x*", "...")), "exclusive"))
    >>> result = conform_or_explain(team_task, labeller, alpha=20.0, telling_cost=0.5)
    >>> [str(difference) for difference in result.told]
    ['(clear c-0-1) does not hold']
    """
    check_alpha(alpha)
    if not math.isfinite(telling_cost) or telling_cost < 0 or max_told < 0:
        raise UsageError("the cost of telling must be finite, and neither it nor the size of a set negative")
    deadline = time.monotonic() + time_limit_s
    plain = plan_explicably(
        team_task, labeller, alpha=alpha, improve_s=improve_s, time_limit_s=time_limit_s, seed=seed
    )
    if plain.plan is None:
        return ToldPlan(plain.outcome, None, (), None, (), None, None, is_complete=True)
    cheapest = search(team_task.task, "anytime", time_limit_s=improve_s, seed=seed)
    plans = [plain.plan]
    if cheapest.operators is not None and cheapest.cost is not None:
        actions = tuple(map(team_task.task.action, cheapest.operators))
        plans.append(joint_plan(team_task, actions, cheapest.cost))

    scales = _Scales(team_task, labeller, alpha, telling_cost)
    untold = best = min((scales.weigh(plan, (), team_task) for plan in plans), key=_objective)
    is_complete = True
    for told in _sets(team_task, labeller, plans, max_told, deadline):
        if cheapest.lower_bound + telling_cost * len(told) >= best.objective:
            continue
        if time.monotonic() > deadline:
            is_complete = False
            break
        corrected = tell(team_task, told)
        planned = plan_explicably(
            corrected, labeller, alpha=alpha, improve_s=improve_s, time_limit_s=time_limit_s, seed=seed
        )
        if planned.plan is not None and planned.plan not in plans:
            plans.append(planned.plan)  # it may be better than all before, even for one who is told nothing
            untold = min(untold, scales.weigh(planned.plan, (), team_task), key=_objective)
        best = min((best, untold, *(scales.weigh(plan, told, corrected) for plan in plans)), key=_objective)
    return ToldPlan(
        outcome=Outcome.SOLVED,
        plan=best.plan,
        told=best.told,
        before_step=best.before_step,
        probabilities=best.probabilities,
        objective=best.objective,
        objective_untold=untold.objective,
        is_complete=is_complete,
    )


@dataclass(frozen=True, slots=True)
class _Weighed:
    plan: JointPlan
    told: tuple[Difference, ...]
    before_step: int | None
    probabilities: tuple[float, ...]
    objective: float


def _objective(weighed: _Weighed) -> float:
    return weighed.objective


class _Scales:
    """Weighs plans with what is told; remembers how they look to a person who is told nothing."""

    def __init__(self, team_task: TeamTask, labeller: "Labeller", alpha: float, telling_cost: float) -> None:
        self.team_task = team_task
        self.labeller = labeller
        self.alpha = alpha
        self.telling_cost = telling_cost
        self._untold: dict[JointPlan, tuple[float, ...]] = {}

    def weigh(self, plan: JointPlan, told: tuple[Difference, ...], corrected: TeamTask) -> _Weighed:
        """Return J of a plan with telling at the latest best time."""
        if plan not in self._untold:
            self._untold[plan] = self.labeller.label(self.team_task, plan.actions).probabilities
        before = self._untold[plan]
        if not told:
            return _Weighed(plan, (), None, before, plan.cost + self.alpha * sum(1 - p for p in before))
        after = self.labeller.label(corrected, plan.actions).probabilities
        step, num_inexplicable = best_time(before, after)
        value = plan.cost + self.alpha * num_inexplicable + self.telling_cost * len(told)
        return _Weighed(plan, told, step, (*before[:step], *after[step:]), value)


def best_time(before: Sequence[float], after: Sequence[float]) -> tuple[int, float]:
    """Return the latest best time to tell, and the expected number of inexplicable steps then.

    Parameters
    ----------
    before, after
        Of each step, the probability that it is expected by a person who was not told, and who was.

    Examples
    --------
    >>> best_time([1.0, 0.25, 0.25, 1.0], [1.0, 0.75, 0.75, 1.0])
    (1, 0.5)
    """
    num_steps = len(before)
    totals = [
        sum(1 - p for p in before[:step]) + sum(1 - p for p in after[step:]) for step in range(num_steps + 1)
    ]
    least = min(totals)
    latest = max(step for step in range(num_steps + 1) if totals[step] <= least + _AS_GOOD)
    return latest, totals[latest]


def _sets(
    team_task: TeamTask,
    labeller: "Labeller",
    plans: Sequence[JointPlan],
    max_told: int,
    deadline: float,
) -> Iterator[tuple[Difference, ...]]:
    """Yield each set of differences once: those that explain the plans' steps, then all by size."""
    seen: set[frozenset[Difference]] = {frozenset()}

    def fresh(told: tuple[Difference, ...]) -> bool:
        is_new = frozenset(told) not in seen
        seen.add(frozenset(told))
        return is_new

    if max_told == 0:
        return
    for plan in tuple(plans):
        left_s = max(deadline - time.monotonic(), 0.0) / 2
        steps = explain(team_task, labeller, plan.actions, max_told=max_told, time_limit_s=left_s)
        together = tuple(dict.fromkeys(difference for step in steps for difference in step.told))
        yield from filter(fresh, (*(step.told for step in steps), together))
    differences = find_differences(team_task.problem)
    for size in range(1, min(max_told, len(differences)) + 1):
        yield from filter(fresh, itertools.combinations(differences, size))

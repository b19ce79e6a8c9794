"""Alpha and the other prices have a meaning, wherever they are handed in."""

import math

import pytest

from explicable.errors import UsageError
from explicable.planning import (
    conform_or_explain,
    front,
    objective,
    plan_classically,
    plan_explicably,
    plan_schedule,
    plan_within_budget,
    rank,
)
from explicable.search import search
from planning.floors import DETOUR, floor, judge_of_progress

USES = {
    "plan_explicably": lambda team, judge, price: plan_explicably(team, judge, alpha=price),
    "plan_schedule": lambda team, judge, price: plan_schedule(team, labeller=judge, alpha=price),
    "rank": lambda team, judge, price: rank(team, judge, [], price),
    "tell": lambda team, judge, price: conform_or_explain(team, judge, alpha=price),
    "telling": lambda team, judge, price: conform_or_explain(team, judge, telling_cost=price),
    "front": lambda team, judge, price: front(team, judge, max_alpha=price),
    "cost": lambda team, judge, price: plan_within_budget(team, judge, max_cost_increase=price),
    "explicability": lambda team, judge, price: plan_within_budget(team, judge, min_explicability=price),
    "anytime": lambda team, judge, price: search(
        team.task, "anytime", alpha=price, scorer=judge.scorer(team)
    ),
    "lazy": lambda team, judge, price: search(team.task, "lazy", alpha=price, scorer=judge.scorer(team)),
    "objective": lambda team, judge, price: objective(
        plan_classically(team).plan, judge.label(team, plan_classically(team).plan.actions), price
    ),
}


@pytest.mark.parametrize("use", USES.values(), ids=USES)
@pytest.mark.parametrize("price", [-1.0, math.inf, -math.inf, math.nan])
def test_negative_infinite_and_undefined_prices_are_refused(use, price):
    with pytest.raises(UsageError):
        use(floor(DETOUR), judge_of_progress(), price)

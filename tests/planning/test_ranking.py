"""Plans in the order of J; what is no plan comes last and says why."""

import math

import pytest

from explicable.errors import UsageError
from explicable.planning.ranking import rank
from planning.floors import DETOUR, command, floor, judge_of_progress, moves, visit

# Without hidden obstacles the person's way through the middle, and one round about.
OPEN = DETOUR.replace("x", ".")
STRAIGHT = [command(1, 3), *moves((1, 1), (1, 2), (1, 3)), visit(1, 3)]
ROUND = [command(1, 3), *moves((1, 1), (2, 1), (2, 2), (1, 2), (1, 3)), visit(1, 3)]
SECRET = [*moves((1, 1), (1, 2), (1, 3)), command(1, 3), visit(1, 3)]


def test_the_order_is_that_of_cost_plus_alpha_times_the_expected_number_of_inexplicable_steps():
    team, labeller = floor(OPEN), judge_of_progress()
    for alpha in (0.0, 1.0, 20.0):
        plans = [ROUND, STRAIGHT, SECRET]
        ranked = rank(team, labeller, plans, alpha)
        values = []
        for plan in ranked:
            assert plan.actions == tuple(plans[plan.number])
            labelled = labeller.label(team, plan.actions)
            inexplicable = sum(1 - p for p in labelled.probabilities)
            assert plan.objective == pytest.approx(plan.cost + alpha * inexplicable)
            values.append(plan.objective)
        assert values == sorted(values)
    assert [plan.number for plan in rank(team, labeller, [ROUND, SECRET, STRAIGHT], 0.0)] == [1, 2, 0]


def test_what_is_no_plan_comes_last_with_the_reason():
    ranked = rank(floor(OPEN), judge_of_progress(), [STRAIGHT[1:], STRAIGHT[:-1], STRAIGHT])
    assert [plan.number for plan in ranked] == [2, 0, 1]
    assert ranked[0].objection is None
    assert "step 3" in ranked[1].objection
    assert "goal" in ranked[2].objection
    assert ranked[1].objective is ranked[2].cost is None
    assert rank(floor(OPEN), judge_of_progress(), []) == []


@pytest.mark.parametrize("alpha", [-1.0, math.inf, math.nan])
def test_an_alpha_without_meaning_is_refused(alpha):
    with pytest.raises(UsageError, match="alpha"):
        rank(floor(OPEN), judge_of_progress(), [STRAIGHT], alpha)

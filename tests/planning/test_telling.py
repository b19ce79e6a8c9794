"""Conform or explain: J of all that was tried, the time of telling, and the two extremes of its price."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.planning.differences import FactDifference
from explicable.planning.explanation import tell
from explicable.planning.telling import best_time, conform_or_explain
from explicable.search import Outcome
from planning.floors import DETOUR, command, floor, judge_of_progress, moves, visit

BLOCKED = FactDifference(("clear", "c-1-2"), holds=False)
OPTIONS = {"alpha": 5.0, "improve_s": 0.1}


def test_cheap_telling_is_done_and_dear_telling_is_not():
    team, labeller = floor(DETOUR, "exclusive"), judge_of_progress()
    told = conform_or_explain(team, labeller, telling_cost=0.1, **OPTIONS)
    assert told.told == (BLOCKED,)
    assert told.is_complete
    assert told.objective < told.objective_untold
    silent = conform_or_explain(team, labeller, telling_cost=1000.0, **OPTIONS)
    assert (silent.told, silent.before_step) == ((), None)
    assert silent.objective == silent.objective_untold == pytest.approx(told.objective_untold)


def test_the_objective_is_what_it_is_said_to_be():
    team, labeller = floor(DETOUR, "exclusive"), judge_of_progress()
    result = conform_or_explain(team, labeller, telling_cost=0.5, **OPTIONS)
    actions, step = result.plan.actions, result.before_step
    before = labeller.label(team, actions).probabilities
    after = labeller.label(tell(team, result.told), actions).probabilities
    assert result.probabilities == (*before[:step], *after[step:])
    inexplicable = sum(1 - p for p in result.probabilities)
    assert result.objective == pytest.approx(result.plan.cost + 5 * inexplicable + 0.5 * len(result.told))
    assert team.task.is_goal(team.task.execute(actions).states[-1])
    untold = result.plan.cost + 5 * sum(1 - p for p in before)
    assert result.objective_untold <= untold + 1e-9  # every plan is weighed without telling too
    assert before[step] < 0.5 <= after[step]  # told right before the first step that it makes expected


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1)), max_size=6))
def test_the_time_of_telling_is_the_best_and_the_latest_such(pairs):
    before, after = [p for p, _ in pairs], [p for _, p in pairs]

    def total(step):
        return sum(1 - p for p in (*before[:step], *after[step:]))

    step, value = best_time(before, after)
    assert value == pytest.approx(total(step))
    for other in range(len(pairs) + 1):
        assert total(other) >= value - 1e-6
        assert other <= step or total(other) > value - 1e-9


def test_without_a_difference_or_a_plan_there_is_nothing_to_tell():
    same = conform_or_explain(floor(DETOUR.replace("x", ".")), judge_of_progress(), **OPTIONS)
    assert same.told == ()
    assert same.is_complete
    team = floor(DETOUR)
    nowhere = team.task.with_goal([("at", "r1", "c-9-9")])
    none = conform_or_explain(type(team)(team.problem, nowhere, team.mental), judge_of_progress(), **OPTIONS)
    assert (none.outcome, none.plan, none.objective) == (Outcome.UNSOLVABLE, None, None)


def test_out_of_time_the_best_so_far_is_given():
    late = conform_or_explain(floor(DETOUR), judge_of_progress(), time_limit_s=0.5, improve_s=0.5, alpha=5.0)
    assert late.outcome is Outcome.SOLVED
    assert late.objective <= late.objective_untold
    assert late.plan.actions[0] == command(1, 3) or late.plan.actions[0] in moves((1, 1), (2, 1))
    assert late.plan.actions[-1] == visit(1, 3)


@pytest.mark.parametrize(
    "options", [{"alpha": -1.0}, {"telling_cost": math.nan}, {"telling_cost": math.inf}, {"max_told": -1}]
)
def test_prices_without_meaning_are_refused(options):
    with pytest.raises(UsageError):
        conform_or_explain(floor(DETOUR), judge_of_progress(), **options)

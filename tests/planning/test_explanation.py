"""The smallest thing to tell, against trying every set."""

import itertools

import pytest

from explicable.errors import UsageError
from explicable.model.grounding import ground_team
from explicable.planning import explanation, plan_classically
from explicable.planning.differences import FactDifference, find_differences
from explicable.planning.explanation import Finding, explain, tell
from planning.floors import DETOUR, PATIENCE_S, command, floor, judge_of_progress, moves, visit
from planning.test_differences import example

LONG = [command(1, 3), *moves((1, 1), (2, 1), (2, 2), (2, 3), (1, 3)), visit(1, 3)]
# Two ways seem short and are blocked; the robot takes the third.
TWO_BLOCKED = "#######\n#..x.*#\n#@.x..#\n#.....#\n#######\n"
THIRD_WAY = [
    command(1, 5),
    *moves((2, 1), (3, 1), (3, 2), (3, 3), (3, 4), (3, 5), (2, 5), (1, 5)),
    visit(1, 5),
]


def test_the_hidden_obstacle_explains_the_detour():
    explained = explain(floor(DETOUR), judge_of_progress(), LONG)
    odd = [step for step in explained if step.finding is not Finding.EXPECTED]
    assert [step.number for step in odd] == [2]
    assert odd[0].told == (FactDifference(("clear", "c-1-2"), holds=False),)
    assert odd[0].probability < 0.5 <= odd[0].probability_told
    assert odd[0].reasons
    assert all(weight < 0 for _, weight in odd[0].reasons)
    assert "(clear c-1-2) does not hold" in str(odd[0])
    assert str(explained[0]).endswith("expected (1.00).")


@pytest.mark.parametrize("make", [lambda: floor(TWO_BLOCKED), lambda: ground_team(example("warehouse"))])
def test_what_is_told_is_enough_and_no_smaller_set_is(make):
    team, labeller = make(), judge_of_progress()
    if team.problem.robot.domain.name.startswith("first-response"):
        plan = THIRD_WAY
    else:
        plan = plan_classically(team).plan.actions
        labeller.schemas = tuple(schema.name for schema in team.problem.robot.domain.actions)
    differences = find_differences(team.problem)
    for step in explain(team, labeller, plan, max_told=2, time_limit_s=PATIENCE_S):
        if step.finding is Finding.EXPLAINED:
            now = labeller.label(tell(team, step.told), plan).probabilities[step.number - 1]
            assert now == step.probability_told >= 0.5
        if step.finding is not Finding.EXPECTED:
            smaller = len(step.told) - 1 if step.told else 2
            for size in range(smaller + 1):
                for told in itertools.combinations(differences, size):
                    assert labeller.label(tell(team, told), plan).probabilities[step.number - 1] < 0.5
            assert step.size_tried == smaller


def test_two_blocked_ways_take_two_facts():
    explained = explain(floor(TWO_BLOCKED), judge_of_progress(), THIRD_WAY)
    odd = [step for step in explained if step.finding is not Finding.EXPECTED]
    assert {step.finding for step in odd} == {Finding.EXPLAINED}
    assert max(len(step.told) for step in odd) == 2


def test_a_step_that_nothing_explains_and_one_that_there_is_no_time_for():
    stray = [LONG[0], *moves((1, 1), (2, 1), (2, 2), (2, 1))]
    nothing = explain(floor(DETOUR), judge_of_progress(), stray)[3]
    assert (nothing.finding, nothing.told, nothing.size_tried) == (Finding.NONE, (), 1)
    assert "up to 1 at a time" in str(nothing)
    late = explain(floor(DETOUR), judge_of_progress(), LONG, time_limit_s=-1.0)[1]
    assert late.finding is Finding.LIMIT
    assert "time" in str(late)
    untold = explain(floor(DETOUR), judge_of_progress(), LONG, max_told=0)[1]
    assert untold.finding is Finding.NONE
    same = floor(DETOUR.replace("x", "."))
    assert "nothing that the person could be told" in str(explain(same, judge_of_progress(), stray)[3])


@pytest.mark.parametrize("options", [{"threshold": 1.5}, {"threshold": float("nan")}, {"max_told": -1}])
def test_options_without_meaning_are_refused(options):
    with pytest.raises(UsageError):
        explain(floor(DETOUR), judge_of_progress(), LONG, **options)


def test_out_of_time_nothing_is_searched_for_any_more(monkeypatch):
    def refuse(*_arguments, **_options):
        raise AssertionError("the time was up")

    monkeypatch.setattr(explanation, "search", refuse)
    late = explain(floor(DETOUR), judge_of_progress(), LONG, time_limit_s=-1.0)
    assert [step.number for step in late if step.finding is Finding.LIMIT] == [2]

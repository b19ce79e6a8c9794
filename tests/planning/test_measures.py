"""All measures together, on a floor with an obstacle that the person does not know."""

import math
from dataclasses import replace

import pytest

from explicable.errors import PlanError
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.planning.measures import measure
from planning.floors import DETOUR, command, floor, judge_of_progress, moves, visit

SHORT = [command(1, 3), *moves((1, 1), (1, 2), (1, 3)), visit(1, 3)]
LONG = [command(1, 3), *moves((1, 1), (2, 1), (2, 2), (2, 3), (1, 3)), visit(1, 3)]


def test_a_detour_is_measured_against_what_the_person_believes():
    measures = measure(floor(DETOUR), LONG, judge_of_progress(), [SHORT, LONG[:1]])
    assert (measures.cost, measures.reaches_goal) == (6, True)
    assert (measures.cost_gap, measures.objection, measures.num_impossible) == (2, None, 0)
    assert measures.labelled.labels == (True, False, True, True, True, True)
    assert measures.distance.actions == pytest.approx(1 - 2 / 8)  # the nearest for each distance
    assert 0 < measures.surprise < math.inf
    assert measures.surprise == pytest.approx(-sum(math.log(p) for p in measures.step_probabilities[1:]))
    assert measures.recognition is None
    assert measures.in_time


def test_a_plan_that_is_none_for_the_person_has_an_infinite_gap_and_a_reason():
    problem = floor(DETOUR).problem
    careful = ground_team(type(problem)(problem.mental, problem.robot))
    measures = measure(careful, SHORT)
    assert measures.cost_gap == math.inf
    assert "step 2" in measures.objection
    assert measures.surprise == math.inf
    assert measures.num_impossible == 2
    unfinished = measure(floor(DETOUR), LONG[:-1])
    assert not unfinished.reaches_goal
    assert unfinished.cost_gap == math.inf
    assert "goal" in unfinished.objection


def test_where_the_person_sees_no_way_there_is_no_gap():
    # The person believes that the corridor is blocked; the robot knows that it is clear.
    robot = floor("#####\n#@.*#\n#####\n").problem.robot
    believed = replace(robot, init=tuple(atom for atom in robot.init if atom != ("clear", "c-1-2")))
    blind = TeamProblem(robot, believed)
    measures = measure(ground_team(blind), SHORT)
    assert measures.cost_gap is None


def test_out_of_time_leaves_out_what_needs_search():
    measures = measure(floor(DETOUR), LONG, judge_of_progress(), [SHORT], time_limit_s=0.0)
    assert not measures.in_time
    assert measures.cost_gap is measures.surprise is measures.step_probabilities is None
    assert measures.labelled is not None
    assert measures.distance is not None


def test_alternative_goals_give_legibility():
    measures = measure(floor(DETOUR), LONG, alternative_goals=[[("at", "r1", "c-2-1")]])
    assert len(measures.recognition.goal_probabilities) == len(LONG) + 1
    assert 0 <= measures.recognition.legibility <= 1


def test_a_plan_that_can_not_be_executed_is_refused():
    with pytest.raises(PlanError, match="step 2"):
        measure(floor(DETOUR), SHORT)

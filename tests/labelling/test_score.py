"""Scores of plans: every variant of method.md, section 2, by hand and by enumeration."""

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.score import PlanScores, score_labels, score_plan
from oracles import crf as oracle

STATE = np.array([[0.8, -0.3], [-0.5, 0.4]])
TRANSITION = np.array([[0.5, -0.2], [-0.4, 0.3]])
MODEL = ConditionalRandomField.from_weights([False, True], ["odd", "even"], STATE, TRANSITION)
FEATURES = [["odd"], ["even"], ["odd", "even"], [], ["even"], ["odd"]]
IS_ROBOT = [True, True, False, True, False, True]
IS_ASKED = [True, False, True, True, False, False]


def test_scores_of_a_plan_match_enumeration():
    scores = score_plan(MODEL, FEATURES, IS_ROBOT, is_asked=IS_ASKED)
    state = [sum((STATE[["odd", "even"].index(f)] for f in position), np.zeros(2)) for position in FEATURES]
    clamped = [-1 if robot else 1 for robot in IS_ROBOT]
    labellings = oracle.distribution(state, TRANSITION, clamped)
    best = oracle.best_labelling(state, TRANSITION, clamped)
    for part, counted in ((scores.paper, [True] * 6), (scores.robot, IS_ROBOT), (scores.asked, IS_ASKED)):

        def fraction(labels, counted=counted):
            return np.mean([label for label, counts in zip(labels, counted, strict=True) if counts])

        mean = sum(p * fraction(labels) for labels, p in labellings)
        assert part.num_steps == sum(counted)
        assert part.by_labels == pytest.approx(fraction(best))
        assert part.expected == pytest.approx(mean)
        assert part.variance == pytest.approx(sum(p * (fraction(y) - mean) ** 2 for y, p in labellings))
    assert (scores.f_paper, scores.f_robot, scores.f_asked) == (
        scores.paper.by_labels,
        scores.robot.by_labels,
        scores.asked.by_labels,
    )
    assert (scores.f_expected, scores.f_robot_expected, scores.f_asked_expected) == (
        scores.paper.expected,
        scores.robot.expected,
        scores.asked.expected,
    )


def test_labels_that_a_person_gave_are_counted_by_the_papers_convention():
    labels = [False, None, False, True, None, False]
    scores = score_labels(labels, IS_ROBOT)
    assert scores.f_paper == pytest.approx(4 / 6)  # the human step labelled False is explicable by definition
    assert scores.f_robot == pytest.approx(2 / 4)
    assert scores.f_asked == pytest.approx(1 / 4)
    assert scores.as_dict() == {
        "f_paper": pytest.approx(4 / 6),
        "f_expected": pytest.approx(4 / 6),
        "f_expected_variance": 0.0,
        "num_paper_steps": 6,
        "f_robot": 0.5,
        "f_robot_expected": 0.5,
        "f_robot_expected_variance": 0.0,
        "num_robot_steps": 4,
        "f_asked": 0.25,
        "f_asked_expected": 0.25,
        "f_asked_expected_variance": 0.0,
        "num_asked_steps": 4,
    }


def test_pooled_is_a_ratio_of_sums_and_macro_a_mean_of_ratios():
    short, long = score_labels([False], [True]), score_labels([True] * 9, [True] * 9)
    nothing = score_labels([], [])
    assert nothing.f_paper is None
    assert PlanScores.pooled([short, long, nothing]).f_robot == pytest.approx(0.9)
    assert PlanScores.macro([short, long, nothing]).f_robot == pytest.approx(0.5)
    assert PlanScores.pooled([nothing]) == nothing == PlanScores.macro([])
    plans = [score_plan(MODEL, FEATURES, IS_ROBOT), score_plan(MODEL, FEATURES[:2], IS_ROBOT[:2])]
    pooled = PlanScores.pooled(plans)
    assert pooled.robot.num_steps == 6
    variances = [plan.robot.variance * plan.robot.num_steps**2 for plan in plans]
    assert pooled.robot.variance == pytest.approx(sum(variances) / 36)


def test_flags_must_fit_the_plan():
    with pytest.raises(UsageError, match="one entry for each step"):
        score_plan(MODEL, FEATURES, IS_ROBOT[:-1])
    with pytest.raises(UsageError, match="one entry for each step"):
        score_labels([True], [True, False])

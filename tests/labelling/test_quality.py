"""Measures of held-out predictions."""

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.labelling.quality import expected_score_error, label_quality
from explicable.labelling.score import score_labels


def test_true_probabilities_are_calibrated_and_beat_the_base_rate():
    rng = np.random.default_rng(0)
    probabilities = rng.random(20_000)
    labels = (rng.random(20_000) < probabilities).tolist()
    quality = label_quality(labels, probabilities)
    assert quality.log_loss == pytest.approx(0.5, abs=0.01)  # the integral of the entropy
    assert quality.base_log_loss == pytest.approx(np.log(2), abs=0.001)
    assert quality.auc == pytest.approx(5 / 6, abs=0.01)
    assert quality.accuracy == pytest.approx(0.75, abs=0.01)
    assert quality.calibration.error < 0.02
    assert quality.calibration.predicted == pytest.approx(np.linspace(0.05, 0.95, 10), abs=0.01)
    assert label_quality(labels, probabilities**3).calibration.error > 0.2


def test_one_label_only_and_certainty_have_a_meaning():
    quality = label_quality([True, None, True], [1.0, 0.0, 1.0])
    assert quality.auc is None
    assert quality.log_loss == pytest.approx(0, abs=1e-12)
    assert quality.calibration.num_steps.tolist() == [2]


@pytest.mark.parametrize(
    ("labels", "probabilities"),
    [([True], [0.5, 0.5]), ([None], [0.5]), ([True], [1.5]), ([True], [float("nan")]), ([], [])],
)
def test_bad_predictions_are_refused(labels, probabilities):
    with pytest.raises(UsageError):
        label_quality(labels, probabilities)


def test_error_of_expected_scores_leaves_out_plans_without_steps():
    robots = score_labels([True, False], [True, True])
    human = score_labels([None], [False])
    best = score_labels([True, True], [True, True])
    assert expected_score_error([robots, human], [best, human]) == pytest.approx(0.5)
    assert expected_score_error([robots, human], [best, human], "paper") == pytest.approx(0.25)
    with pytest.raises(UsageError):
        expected_score_error([human], [human])
    with pytest.raises(UsageError):
        expected_score_error([robots], [best], "num_steps")
    with pytest.raises(UsageError):
        expected_score_error([robots], [])

"""How good a labeller's probabilities are on plans that it was not trained on."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explicable.errors import UsageError
from explicable.labelling.score import PlanScores


@dataclass(frozen=True, slots=True)
class Calibration:
    """How often steps were explicable, by predicted probability.

    Attributes
    ----------
    predicted
        Mean predicted probability of each non-empty bin, ascending.
    observed
        Fraction of explicable steps in the bin.
    num_steps
        Steps in the bin.
    """

    predicted: NDArray[np.float64]
    observed: NDArray[np.float64]
    num_steps: NDArray[np.int64]

    @property
    def error(self) -> float:
        """Expected calibration error: mean distance of the two, each step counting alike."""
        return float(np.average(np.abs(self.predicted - self.observed), weights=self.num_steps))


@dataclass(frozen=True, slots=True)
class LabelQuality:
    """Quality of predicted labels of single steps.

    Attributes
    ----------
    num_steps
        Labelled steps that were compared.
    log_loss
        Mean of -log(probability of the label given), in nats.
    base_log_loss
        The same for one who always predicts the overall rate.
    accuracy
        Fraction of steps whose label has probability over one half.
    auc
        Probability that an explicable step gets a higher probability than an inexplicable one; None if all
        steps have the same label.
    calibration
        By ten bins of equal width.
    """

    num_steps: int
    log_loss: float
    base_log_loss: float
    accuracy: float
    auc: float | None
    calibration: Calibration


def label_quality(
    labels: Sequence[bool | None], probabilities: ArrayLike, *, num_bins: int = 10
) -> LabelQuality:
    """Compare labels with predicted probabilities of *explicable*, over all steps of all held-out plans.

    Parameters
    ----------
    labels
        Whether each step was called explicable; None where nobody was asked, which is left out.
    probabilities
        Predicted probability that each step is explicable.
    num_bins
        Bins of the calibration curve.

    Raises
    ------
    UsageError
        If lengths differ, no step is labelled, or a probability is not one.

    Examples
    --------
    >>> quality = label_quality([True, False, None, True], [0.9, 0.2, 0.5, 0.6])
    >>> quality.num_steps, round(quality.log_loss, 3), quality.accuracy, quality.auc
    (3, 0.28, 1.0, 1.0)
    """
    from sklearn.metrics import log_loss, roc_auc_score

    predicted = np.array(probabilities, dtype=np.float64)
    if predicted.shape != (len(labels),):
        raise UsageError("one probability is needed for each label")
    if not ((predicted >= 0) & (predicted <= 1)).all():
        raise UsageError("probabilities must lie between 0 and 1")
    asked = np.array([label is not None for label in labels], dtype=np.bool_)
    if not asked.any():
        raise UsageError("there is no labelled step to compare with")
    truth = np.array([bool(label) for label in labels])[asked]
    predicted = predicted[asked]
    rate = np.full(len(truth), truth.mean())
    return LabelQuality(
        num_steps=len(truth),
        log_loss=float(log_loss(truth, predicted, labels=[False, True])),
        base_log_loss=float(log_loss(truth, rate, labels=[False, True])),
        accuracy=float(((predicted > 0.5) == truth).mean()),
        auc=float(roc_auc_score(truth, predicted)) if 0 < truth.mean() < 1 else None,
        calibration=_calibrate(truth, predicted, num_bins),
    )


def expected_score_error(
    predicted: Sequence[PlanScores], observed: Sequence[PlanScores], part: str = "robot"
) -> float:
    """Return the mean absolute error of E[F] over plans; plans in which no step counts are left out.

    Parameters
    ----------
    predicted, observed
        Scores of the same plans, by a labeller and by a person.
    part
        Which steps count: ``paper``, ``robot`` or ``asked``.

    Raises
    ------
    UsageError
        If the two are not of the same plans, no step counts, or there is no such part.

    Examples
    --------
    >>> from explicable.labelling.score import score_labels
    >>> expected_score_error([score_labels([True], [True])], [score_labels([False], [True])])
    1.0
    """
    if part not in {"paper", "robot", "asked"}:
        raise UsageError(f"steps that count are those of paper, robot or asked, not {part!r}")
    if len(predicted) != len(observed):
        raise UsageError("predicted and observed scores must be of the same plans")
    pairs = [
        (getattr(one, part).expected, getattr(other, part).expected)
        for one, other in zip(predicted, observed, strict=True)
    ]
    errors = [abs(guess - truth) for guess, truth in pairs if guess is not None and truth is not None]
    if not errors:
        raise UsageError("there is no plan with steps that count")
    return float(np.mean(errors))


def _calibrate(truth: NDArray[np.bool_], predicted: NDArray[np.float64], num_bins: int) -> Calibration:
    bins = np.minimum((predicted * num_bins).astype(np.int64), num_bins - 1)
    num_steps = np.bincount(bins, minlength=num_bins)
    used = num_steps > 0
    sums = np.bincount(bins, predicted, num_bins)[used]
    positives = np.bincount(bins, truth.astype(np.float64), num_bins)[used]
    return Calibration(sums / num_steps[used], positives / num_steps[used], num_steps[used].astype(np.int64))

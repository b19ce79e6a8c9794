"""Several annotators: how far they agree, what each of their answers is worth, what they say together.

Disagreement is kept: the labeller is trained on every annotator's own traces, each with the annotator's
weight, and `aggregate` gives probabilities rather than a vote.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from explicable.errors import UsageError

Ratings: TypeAlias = Sequence[Mapping[str, Hashable]]
"""For each item (a step that people were asked about) the labels it got, by annotator."""


@dataclass(frozen=True, slots=True)
class Aggregation:
    """What annotators say together (Dawid & Skene, 1979).

    Attributes
    ----------
    classes
        The labels, in order.
    annotators
        Names, sorted.
    probabilities
        Probability of each label (columns) for each item (rows).
    confusion
        ``confusion[a, i, j]``: probability that annotator a says j where the true label is i.
    prior
        Probability of each label.
    log_likelihood
        Of all ratings, at the end.
    num_iterations
        Rounds of expectation and maximisation.
    """

    classes: tuple[Hashable, ...]
    annotators: tuple[str, ...]
    probabilities: NDArray[np.float64]
    confusion: NDArray[np.float64]
    prior: NDArray[np.float64]
    log_likelihood: float
    num_iterations: int

    def weights(self) -> dict[str, float]:
        """Return what an answer of each annotator is worth: 1 if never wrong, 0 if no better than chance.

        The measure is informedness: the mean over true labels of the probability to name them, rescaled so
        that answers that do not depend on the truth get 0; negative values become 0.
        """
        if len(self.classes) == 1:
            return dict.fromkeys(self.annotators, 1.0)
        chance = 1 / len(self.classes)
        rates = self.confusion.diagonal(axis1=1, axis2=2).mean(axis=1)
        worth = np.clip((rates - chance) / (1 - chance), 0.0, 1.0)
        return dict(zip(self.annotators, worth.tolist(), strict=True))


def krippendorff_alpha(ratings: Ratings) -> float:
    """Return Krippendorff's alpha for nominal labels: 1 for perfect agreement, 0 for what chance would give.

    Items with fewer than two labels say nothing about agreement. The result is 1 if all labels are the same.

    Raises
    ------
    UsageError
        If no item has two labels.

    Notes
    -----
    Krippendorff, *Computing Krippendorff's Alpha-Reliability*, 2011.

    Examples
    --------
    >>> krippendorff_alpha([{"ann": True, "bob": True}, {"ann": False, "bob": False}])
    1.0
    >>> round(krippendorff_alpha([{"ann": True, "bob": True}, {"ann": True, "bob": False}]), 3)
    0.0
    """
    classes = _classes(ratings)
    counts = np.array([[list(item.values()).count(c) for c in classes] for item in ratings if len(item) > 1])
    if not counts.size:
        raise UsageError("agreement needs an item that two annotators labelled")
    sizes = counts.sum(axis=1)
    totals = counts.sum(axis=0)
    num_labels = totals.sum()
    observed = ((sizes**2 - (counts**2).sum(axis=1)) / (sizes - 1)).sum() / num_labels
    expected = (num_labels**2 - (totals**2).sum()) / (num_labels * (num_labels - 1))
    return 1.0 if expected == 0 else float(1 - observed / expected)


def aggregate(
    ratings: Ratings, *, smoothing: float = 0.1, max_iterations: int = 500, tolerance: float = 1e-9
) -> Aggregation:
    """Estimate true labels and annotators' reliability together, by expectation maximisation.

    Parameters
    ----------
    ratings
        Labels by annotator for each item; an item may have none.
    smoothing
        Added to every count of what an annotator said where, so that a few ratings do not make anyone
        infallible.
    max_iterations, tolerance
        Stop after so many rounds, or when the log-likelihood gains less than this fraction.

    Raises
    ------
    UsageError
        If there is no rating, or a parameter is out of range.

    Notes
    -----
    Dawid & Skene, *Maximum Likelihood Estimation of Observer Error-Rates Using the EM Algorithm*, 1979.
    Starts at the shares of votes; deterministic.

    Examples
    --------
    >>> ratings = [{"ann": True, "bob": True, "eve": False}, {"ann": False, "bob": False, "eve": True}] * 5
    >>> result = aggregate(ratings)
    >>> result.probabilities.round(2)[0].tolist(), result.weights()["eve"]
    ([0.0, 1.0], 0.0)
    """
    classes = _classes(ratings)
    annotators = tuple(sorted({name for item in ratings for name in item}))
    if not annotators:
        raise UsageError("there is no rating")
    if not (np.isfinite(smoothing) and smoothing >= 0):
        raise UsageError(f"smoothing must be finite and at least 0, not {smoothing}")
    said = np.zeros((len(ratings), len(annotators), len(classes)))
    for number, item in enumerate(ratings):
        for name, label in item.items():
            said[number, annotators.index(name), classes.index(label)] = 1.0
    votes = said.sum(axis=1) + 1e-12
    probabilities = votes / votes.sum(axis=1, keepdims=True)
    rated = said.any(axis=(1, 2))
    log_likelihood, before, num_iterations = -np.inf, -np.inf, 0
    for _ in range(max_iterations):
        num_iterations += 1
        prior = probabilities[rated].mean(axis=0)
        confusion = np.einsum("ni,naj->aij", probabilities, said) + smoothing + 1e-12
        confusion /= confusion.sum(axis=2, keepdims=True)
        log_joint = np.log(np.maximum(prior, 1e-300)) + np.einsum("naj,aij->ni", said, np.log(confusion))
        log_evidence = np.logaddexp.reduce(log_joint, axis=1)
        probabilities = np.exp(log_joint - log_evidence[:, None])
        log_likelihood = float(log_evidence[rated].sum())
        if abs(log_likelihood - before) <= tolerance * abs(log_likelihood):
            break
        before = log_likelihood
    return Aggregation(classes, annotators, probabilities, confusion, prior, log_likelihood, num_iterations)


def _classes(ratings: Ratings) -> tuple[Hashable, ...]:
    labels = {label for item in ratings for label in item.values()}
    if None in labels:
        raise UsageError("an annotator who was not asked must be left out, not labelled None")
    return tuple(sorted(labels, key=lambda label: (type(label).__name__, str(label))))

"""Models that each stand for an annotator who is not among those of the training traces.

The annotators are a sample of a population. How much they differ is estimated as in a meta-analysis with
random effects (DerSimonian & Laird, *Meta-analysis in clinical trials*, 1986): by how much their counts of
explicable steps vary beyond what the labeller itself expects of chance.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.learning import CLASSES, TrainingData
from explicable.labelling.score import mean_and_variance
from explicable.labelling.uncertainty import bootstrap_weights


def fit_population(
    model: ConditionalRandomField,
    data: TrainingData,
    rng: np.random.Generator,
    num_draws: int,
    sample_weight: Sequence[float],
) -> list[ConditionalRandomField]:
    """Train models that each stand for a new annotator, by a Bayesian bootstrap over annotators.

    A draw weighs the annotators at random, trains, estimates the variance of the annotators' leniency (an
    offset, in log odds, of every step), and takes on the offset of a new one. Given n annotators with the
    variance s^2, a new one's offset is distributed as Student's t with n - 1 degrees of freedom, scaled by
    ``s sqrt((n + 1) / (n - 1))``. The offsets of all draws together are quantiles of that t, in random order.
    Of a single annotator, traces are weighed, and there is no offset.

    Parameters
    ----------
    model
        Gives the parameters and is not changed.
    data
        What to train on.
    rng
        Source of weights and of the order of offsets.
    num_draws
        Number of models.
    sample_weight
        Weight of each trace; multiplied by that of the draw.
    """
    from scipy.special import stdtrit

    names = sorted(set(data.annotators))
    group = np.array([names.index(name) for name in data.annotators])
    if len(names) == 1:
        group = np.arange(len(data.labels))
    training = model.prepare(data.sequences(), data.answers(), data.given())
    copies = 1 + data.num_copies
    base = np.array(sample_weight)
    start = training.minimise(np.repeat(base, copies)).weights
    share = np.bincount(group, base) / np.bincount(group)
    models = []
    quantiles = rng.permutation((np.arange(num_draws) + 0.5) / num_draws)
    for weights, quantile in zip(
        bootstrap_weights(rng, len(share), num_draws), quantiles.tolist(), strict=True
    ):
        drawn = ConditionalRandomField(**model.get_params())
        drawn.adopt(training, training.minimise(np.repeat(base * weights[group], copies), start))
        offset = 0.0
        if len(names) > 1:
            variance = _leniency_variance(drawn, data, group, share * weights)
            scale = np.sqrt(variance * (len(names) + 1) / (len(names) - 1))
            offset = float(scale * stdtrit(len(names) - 1, quantile))
        models.append(_shift(drawn, data.step_names, offset))
    return models


def _leniency_variance(
    model: ConditionalRandomField,
    data: TrainingData,
    group: NDArray[np.int64],
    weights: NDArray[np.float64],
) -> float:
    """Estimate the variance of annotators' offsets, in squared log odds; 0 if they vary no more than chance.

    The score of an annotator's offset is the count of explicable steps beyond the expected count, its
    information I the variance of the count; the squared score is I + variance * I^2 on average.
    """
    clamp = [[None if row else True for row in rows] for rows in data.features]
    counted = [
        [bool(row) and label is not None for row, label in zip(rows, labels, strict=True)]
        for rows, labels in zip(data.features, data.labels, strict=True)
    ]
    seen = [
        sum(label is True for label, counts in zip(labels, row, strict=True) if counts)
        for labels, row in zip(data.labels, counted, strict=True)
    ]
    counts = model.predict_counts(data.features, empty=False, clamp=clamp, counted=counted)
    expected, variance = np.array([mean_and_variance(count) for count in counts]).T
    score = np.bincount(group, np.array(seen) - expected)
    information = np.bincount(group, variance)
    scale = float(weights @ information**2)
    return max(0.0, float(weights @ (score**2 - information)) / scale) if scale > 0 else 0.0


def _shift(model: ConditionalRandomField, step_names: set[str], offset: float) -> ConditionalRandomField:
    """Return the model with an offset, in log odds of explicable, in the weights of all robots' steps."""
    weights = model.state_weights_.copy()
    steps = [number for number, name in enumerate(model.feature_names_) if name in step_names]
    weights[steps] += [offset / 2, -offset / 2]
    return ConditionalRandomField.from_weights(
        CLASSES, model.feature_names_, weights, model.transition_weights_
    )

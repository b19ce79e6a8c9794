"""How sure a labeller is: the chain's own spread, and that of its weights by a Bayesian bootstrap.

The Bayesian bootstrap (Rubin, *The Bayesian Bootstrap*, 1981) trains again under random weights of traces. A
mixture over these models of the distributions of a count holds both kinds of uncertainty.
"""

from collections.abc import Iterable, Sequence
from functools import reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explicable.errors import UsageError
from explicable.labelling.crf import ConditionalRandomField, LabelSequences
from explicable.labelling.sequences import FeatureSequence
from explicable.labelling.training import check_sample_weight


def bootstrap_weights(rng: np.random.Generator, num_traces: int, num_draws: int) -> NDArray[np.float64]:
    """Draw weights of traces, ``num_draws x num_traces``, from a flat Dirichlet; rows sum to `num_traces`.

    Raises
    ------
    UsageError
        If there is no trace, or nothing to draw.

    Examples
    --------
    >>> bootstrap_weights(np.random.default_rng(0), 3, 2).sum(axis=1)
    array([3., 3.])
    """
    if num_traces < 1 or num_draws < 1:
        raise UsageError("a bootstrap needs at least one trace and one draw")
    return rng.dirichlet(np.ones(num_traces), size=num_draws) * num_traces


def fit_bootstrap(
    model: ConditionalRandomField,
    X: Iterable[FeatureSequence],
    y: LabelSequences,
    rng: np.random.Generator,
    num_draws: int,
    sample_weight: ArrayLike | None = None,
) -> list[ConditionalRandomField]:
    """Return models with the parameters of `model`, trained under bootstrap weights.

    Parameters
    ----------
    model
        Gives the parameters; it need not be trained, and is not changed.
    X, y, sample_weight
        As in `ConditionalRandomField.fit`; bootstrap weights multiply `sample_weight`.
    rng
        Source of the weights.
    num_draws
        Number of models.

    Examples
    --------
    >>> X, y = [[["near"]], [["far"]], [["near"]]], [[True], [False], [True]]
    >>> models = fit_bootstrap(ConditionalRandomField(), X, y, np.random.default_rng(0), 5)
    >>> mix([m.predict_counts([[["near"]]], empty=False)[0] for m in models]).round(1).tolist()
    [0.3, 0.7]
    """
    training = model.prepare(X, y)
    base = check_sample_weight(sample_weight, training.num_sequences)
    start = training.minimise(base).weights
    models = []
    for weights in bootstrap_weights(rng, training.num_sequences, num_draws):
        drawn = ConditionalRandomField(**model.get_params())
        models.append(drawn.adopt(training, training.minimise(base * weights, start)))
    return models


def mix(distributions: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the mixture in equal parts of one count's distributions under several models.

    Raises
    ------
    UsageError
        If there is no distribution.

    Examples
    --------
    >>> mix([np.array([1.0, 0.0]), np.array([0.0, 1.0])]).tolist()
    [0.5, 0.5]
    """
    if not distributions:
        raise UsageError("there is no distribution to mix")
    mean: NDArray[np.float64] = np.mean(distributions, axis=0)
    return mean


def add(distributions: Iterable[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the distribution of a sum of independent counts, such as those of several plans under one model.

    Examples
    --------
    >>> add([np.array([0.5, 0.5]), np.array([0.5, 0.5])]).tolist()
    [0.25, 0.5, 0.25]
    """
    return reduce(np.convolve, distributions, np.ones(1))


def fraction_interval(distribution: NDArray[np.float64], level: float = 0.95) -> tuple[float, float]:
    """Return the central interval of F = count / steps, by mid-P.

    Counts are whole numbers, so no interval holds exactly `level`. One whose ends count in full always holds
    more. Here a count belongs to the interval if what lies beyond it, and half of its own probability, is
    more than half of ``1 - level`` on either side (Lancaster, *Significance tests in discrete distributions*,
    1961): on average over plans such intervals hold their level.

    Parameters
    ----------
    distribution
        Entry k: probability that k steps are explicable, of ``len(distribution) - 1`` steps that count.
    level
        Between 0 and 1.

    Raises
    ------
    UsageError
        If no step counts or the level is out of range.

    Examples
    --------
    >>> fraction_interval(np.array([0.01, 0.04, 0.2, 0.5, 0.25]), level=0.9)
    (0.5, 1.0)
    """
    num_steps = len(distribution) - 1
    if num_steps < 1:
        raise UsageError("no step counts: there is no fraction to bound")
    if not 0 < level < 1:
        raise UsageError(f"the level of an interval must lie between 0 and 1, not {level}")
    tail = (1 - level) / 2 + 1e-12  # what rounding leaves of a zero probability must not widen the interval
    beyond = np.cumsum(distribution) - distribution / 2
    low = int(np.searchsorted(beyond, tail, side="right"))
    high = int(np.searchsorted(beyond, 1 - tail, side="left")) - 1
    # Between two likely counts there may be none that belongs: then both do.
    low, high = min(low, high), max(low, high)
    return max(low, 0) / num_steps, min(high, num_steps) / num_steps

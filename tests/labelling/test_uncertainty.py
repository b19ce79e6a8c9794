"""Intervals: they cover what they promise when the model is true, and hold the spread of the weights."""

from functools import reduce

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.uncertainty import add, bootstrap_weights, fit_bootstrap, fraction_interval, mix


def test_bootstrap_is_seeded_and_spreads_more_with_fewer_traces():
    rng = np.random.default_rng(2)
    X = [[["a"] if rng.random() < 0.5 else ["b"] for _ in range(4)] for _ in range(60)]
    y = [[bool(rng.random() < (0.8 if position == ["a"] else 0.4)) for position in row] for row in X]
    crf = ConditionalRandomField(c2=0.1)

    def spread(num_traces):
        models = fit_bootstrap(crf, X[:num_traces], y[:num_traces], np.random.default_rng(0), 30)
        return np.std([model.predict_marginals([[["a"]]])[0][0, 1] for model in models])

    assert spread(60) < 0.7 * spread(6)
    assert spread(20) == spread(20)


def test_weights_of_traces_are_those_of_a_flat_dirichlet():
    weights = bootstrap_weights(np.random.default_rng(0), 5, 4000)
    assert weights.sum(axis=1) == pytest.approx(5)
    assert weights.mean(axis=0) == pytest.approx(1, abs=0.05)
    assert (weights / 5).var(axis=0) == pytest.approx(4 / (25 * 6), rel=0.1)


@given(st.lists(st.floats(0.001, 1), min_size=2, max_size=40), st.sampled_from([0.5, 0.9, 0.95]))
def test_intervals_hold_what_has_more_than_the_tail_beyond_it(weights, level):
    distribution = np.array(weights) / sum(weights)
    low, high = (round(end * (len(weights) - 1)) for end in fraction_interval(distribution, level))
    tail = (1 - level) / 2
    beyond = [distribution[:k].sum() + distribution[k] / 2 for k in range(len(weights))]
    inside = [k for k, p in enumerate(beyond) if tail + 1e-9 < p < 1 - tail - 1e-9]
    assert 0 <= low <= high < len(weights)
    assert set(inside) <= set(range(low, high + 1))
    if inside:
        assert high - low + 1 <= len([p for p in beyond if tail - 1e-9 < p < 1 - tail + 1e-9])
    assert distribution[low : high + 1].sum() + tail > level / 2  # never far from the middle


def test_intervals_hold_their_level_on_average_over_plans():
    rng = np.random.default_rng(0)
    covered = []
    for _ in range(4000):
        num_steps, rate = rng.integers(5, 40), rng.beta(8, 2)
        distribution = reduce(np.convolve, [np.array([1 - rate, rate])] * num_steps, np.ones(1))
        low, high = fraction_interval(distribution, 0.95)
        covered.append(low <= rng.binomial(num_steps, rate) / num_steps <= high)
    assert np.mean(covered) == pytest.approx(0.95, abs=0.015)


def test_sums_and_mixtures_of_counts():
    coin = np.array([0.5, 0.5])
    assert add([coin] * 3) == pytest.approx(np.array([1, 3, 3, 1]) / 8)
    assert add([]).tolist() == [1.0]
    assert mix([np.array([1.0, 0.0]), coin]) == pytest.approx([0.75, 0.25])
    assert fraction_interval(np.array([0.0, 0.0, 1.0])) == (1.0, 1.0)


@pytest.mark.parametrize(
    "misuse",
    [
        lambda: mix([]),
        lambda: fraction_interval(np.ones(1)),
        lambda: fraction_interval(np.ones(2) / 2, level=1.0),
        lambda: bootstrap_weights(np.random.default_rng(0), 0, 1),
    ],
)
def test_misuse_is_refused(misuse):
    with pytest.raises(UsageError):
        misuse()

"""The compiled loss and its gradient against enumeration and differences."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import approx_fprime

from explicable import _core
from oracles import crf as oracle


def random_problem(
    rng, num_labels, lengths=(4, 0, 1, 3), num_features=3, num_rows=5, unobserved=0.4, given=0.0
):
    """A random set of sequences: arguments of SequenceLoss."""
    counts = rng.integers(0, 3, num_rows)
    num_positions = sum(lengths)
    labels = rng.integers(0, num_labels, num_positions)
    labels[rng.random(num_positions) < unobserved] = -1
    known = np.where(rng.random(num_positions) < given, labels, -1)
    return {
        "num_labels": num_labels,
        "num_features": num_features,
        "row_offsets": np.concatenate([[0], np.cumsum(counts)]),
        "row_features": rng.integers(0, num_features, counts.sum()).astype(np.int32),
        "row_values": rng.normal(size=counts.sum()),
        "offsets": np.concatenate([[0], np.cumsum(lengths)]),
        "position_rows": rng.integers(0, num_rows, num_positions).astype(np.int32),
        "position_labels": labels.astype(np.int32),
        "position_given": known.astype(np.int32) if given else None,
    }


def oracle_loss(problem, weights, sequence_weights):
    num_labels = problem["num_labels"]
    state_weights = weights[: -(num_labels**2)].reshape(-1, num_labels)
    transition = weights[-(num_labels**2) :].reshape(num_labels, num_labels)
    total = 0.0
    offsets, row_offsets = problem["offsets"], problem["row_offsets"]
    for weight, start, end in zip(sequence_weights, offsets[:-1], offsets[1:], strict=True):
        if start == end:
            continue
        state = np.zeros((end - start, num_labels))
        for t, row in enumerate(problem["position_rows"][start:end]):
            for k in range(row_offsets[row], row_offsets[row + 1]):
                state[t] += problem["row_values"][k] * state_weights[problem["row_features"][k]]
        labels = problem["position_labels"][start:end]
        given = problem["position_given"]
        known = () if given is None else (given[start:end],)
        total += weight * (
            oracle.log_partition(state, transition, *known) - oracle.log_partition(state, transition, labels)
        )
    return total


@given(
    st.integers(0, 10**6),
    st.sampled_from([2, 3, 5, 7]),
    st.sampled_from([0.5, 300.0]),
    st.sampled_from([0.0, 0.4, 1.0]),
    st.sampled_from([0.0, 0.5]),
)
@settings(max_examples=100)
def test_loss_and_gradient_match_enumeration(seed, num_labels, size, unobserved, share_given):
    """Scores of hundreds go through the passes in log space, small ones through the scaled passes."""
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, num_labels, unobserved=unobserved, given=share_given)
    loss = _core.SequenceLoss(**problem)
    weights = rng.normal(scale=size, size=(3 + num_labels) * num_labels)
    sequence_weights = rng.uniform(0, 2, 4)
    value, gradient = loss(weights, sequence_weights)
    assert value == pytest.approx(oracle_loss(problem, weights, sequence_weights), rel=1e-9, abs=1e-9)
    if size < 1:
        numeric = approx_fprime(weights, lambda w: loss(w, sequence_weights)[0], 1e-6)
        assert gradient == pytest.approx(numeric, abs=1e-4)


@pytest.mark.parametrize("num_labels", [2, 3])
def test_scaled_and_log_space_passes_agree_where_one_hands_over_to_the_other(num_labels):
    problem = random_problem(np.random.default_rng(1), num_labels, num_features=1, lengths=(40, 0, 1, 9))
    problem["row_values"][:] = 1.0
    loss = _core.SequenceLoss(**problem)
    results = []
    for largest in (60.0 * (1 - 1e-13), 60.0 * (1 + 1e-13)):
        weights = np.zeros((1 + num_labels) * num_labels)
        weights[1] = largest / np.diff(problem["row_offsets"]).max()
        weights[-1] = largest
        results.append(loss(weights, np.ones(4)))
    assert results[0][0] == pytest.approx(results[1][0], rel=1e-11)
    assert results[0][1] == pytest.approx(results[1][1], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("num_labels", 1),
        ("num_features", 2),
        ("num_features", -1),
        ("row_offsets", np.array([1, 2])),
        ("row_offsets", np.array([], np.int64)),
        ("row_offsets", np.array([0, 9, 3])),
        ("row_values", np.array([1.0])),
        ("row_values", np.array([1.0, np.nan, 1.0])),
        ("row_features", np.array([0, -1, 2], np.int32)),
        ("offsets", np.array([0, 2])),
        ("offsets", np.array([0, 5, 3])),
        ("position_rows", np.array([0, 2, 0], np.int32)),
        ("position_rows", np.array([0, -1, 0], np.int32)),
        ("position_labels", np.array([0, 1], np.int32)),
        ("position_labels", np.array([0, 2, 1], np.int32)),
        ("position_labels", np.array([0, -2, 1], np.int32)),
    ],
)
def test_arrays_that_do_not_fit_together_are_refused(name, value):
    arguments = {
        "num_labels": 2,
        "num_features": 3,
        "row_offsets": np.array([0, 1, 3]),
        "row_features": np.array([0, 1, 2], np.int32),
        "row_values": np.ones(3),
        "offsets": np.array([0, 3]),
        "position_rows": np.array([0, 1, 0], np.int32),
        "position_labels": np.array([0, 1, -1], np.int32),
    }
    _core.SequenceLoss(**arguments)(np.zeros(10), np.ones(1))
    with pytest.raises(ValueError, match=r"."):
        _core.SequenceLoss(**arguments | {name: value})


@pytest.mark.parametrize(
    ("weights", "sequence_weights"),
    [
        (np.zeros(9), np.ones(1)),
        (np.zeros(10), np.ones(2)),
        (np.full(10, np.nan), np.ones(1)),
        (np.zeros(10), np.array([np.inf])),
    ],
)
def test_weights_that_do_not_fit_are_refused(weights, sequence_weights):
    offsets, ids = np.array([0, 1, 3]), np.array([0, 1, 2], np.int32)
    loss = _core.SequenceLoss(2, 3, offsets, ids, np.ones(3), np.array([0, 1]), ids[:1], ids[:1])
    with pytest.raises(ValueError, match=r"."):
        loss(weights, sequence_weights)

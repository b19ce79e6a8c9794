"""The compiled passes over chains against enumeration of all labellings."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable import _core
from oracles import crf as oracle


@st.composite
def chains(draw, integer_scores=False):
    num_labels = draw(st.integers(2, 4))
    num_positions = draw(st.integers(1, 5))
    largest = 2 if integer_scores else draw(st.sampled_from([1.0, 20.0, 800.0]))
    score = st.integers(-2, 2) if integer_scores else st.floats(-largest, largest)
    size = num_positions * num_labels
    state = np.array(draw(st.lists(score, min_size=size, max_size=size)), dtype=np.float64)
    transition = np.array(
        draw(st.lists(score, min_size=num_labels**2, max_size=num_labels**2)), dtype=np.float64
    )
    clamped = draw(st.lists(st.integers(-1, num_labels - 1), min_size=num_positions, max_size=num_positions))
    return (
        state.reshape(num_positions, num_labels),
        transition.reshape(num_labels, num_labels),
        np.array(clamped, dtype=np.int32),
    )


@given(chains())
@settings(max_examples=150)
def test_marginals_match_enumeration(chain):
    assert _core.marginals(*chain) == pytest.approx(oracle.marginals(*chain), abs=1e-9)


@given(chains(integer_scores=True))
@settings(max_examples=150)
def test_viterbi_matches_enumeration_and_breaks_ties_towards_low_labels(chain):
    assert _core.viterbi(*chain).tolist() == list(oracle.best_labelling(*chain))


@given(chains(), st.lists(st.booleans(), min_size=5, max_size=5), st.integers(0, 3))
@settings(max_examples=150)
def test_count_distribution_matches_enumeration(chain, flags, empty):
    state, transition, clamped = chain
    counted = np.array(flags[: len(state)], dtype=np.uint8)
    expected = oracle.count_distribution(state, transition, empty, clamped, counted)
    assert _core.count_distribution(*chain, empty, counted) == pytest.approx(expected, abs=1e-9)


NOTHING = np.empty(0, dtype=np.int32)


def test_empty_sequences_have_no_labels_and_count_nothing():
    state, transition = np.empty((0, 2)), np.zeros((2, 2))
    assert _core.viterbi(state, transition, NOTHING).shape == (0,)
    assert _core.marginals(state, transition, NOTHING).shape == (0, 2)
    assert _core.count_distribution(state, transition, NOTHING, 0, np.empty(0, np.uint8)).tolist() == [1.0]


@pytest.mark.parametrize(
    ("state", "transition", "clamped"),
    [
        (np.zeros((3, 2)), np.zeros((3, 3)), NOTHING),
        (np.zeros((3, 2)), np.zeros((2, 3)), NOTHING),
        (np.zeros((3, 0)), np.zeros((0, 0)), NOTHING),
        (np.zeros((3, 2)), np.zeros((2, 2)), np.zeros(2, np.int32)),
        (np.zeros((1, 2)), np.zeros((2, 2)), np.array([2], np.int32)),
        (np.zeros((1, 2)), np.zeros((2, 2)), np.array([-2], np.int32)),
        (np.full((1, 2), np.nan), np.zeros((2, 2)), NOTHING),
        (np.zeros((1, 2)), np.full((2, 2), np.inf), NOTHING),
        (np.full((2, 2), 1e308), np.full((2, 2), 1e308), NOTHING),
    ],
)
def test_arrays_that_do_not_fit_are_refused(state, transition, clamped):
    for function in (_core.viterbi, _core.marginals):
        with pytest.raises(ValueError, match=r"."):
            function(state, transition, clamped)


def test_arrays_of_the_wrong_type_are_refused():
    with pytest.raises(TypeError):
        _core.viterbi(np.zeros((1, 2), np.float32), np.zeros((2, 2)), NOTHING)
    with pytest.raises(TypeError):
        _core.viterbi(np.zeros((2, 1)).T.repeat(2, 1)[:, ::2], np.zeros((2, 2)), NOTHING.astype(np.int64))

"""Types of the compiled core; one section per file of ``cpp/bindings``."""

import numpy as np
from numpy.typing import NDArray

# --- task and grounding (cpp/bindings/task.cpp) ---

# --- search (cpp/bindings/search.cpp) ---

# --- labelling (cpp/bindings/labelling.cpp) ---

def state_scores(
    offsets: NDArray[np.int64],
    features: NDArray[np.int32],
    values: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Scores (rows x labels) of feature rows; empty `values`: all are 1."""

def viterbi(
    state: NDArray[np.float64], transition: NDArray[np.float64], clamped: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Most probable labels; `clamped` is empty or holds a label or -1 for each position."""

def marginals(
    state: NDArray[np.float64], transition: NDArray[np.float64], clamped: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Probabilities of labels, positions x labels."""

def count_distribution(
    state: NDArray[np.float64],
    transition: NDArray[np.float64],
    clamped: NDArray[np.int32],
    empty: int,
    counted: NDArray[np.uint8],
) -> NDArray[np.float64]:
    """Distribution of the number of counted positions with a label other than `empty`."""

class SequenceLoss:
    """Negative log-likelihood of labelled sequences and its gradient."""

    def __init__(
        self,
        num_labels: int,
        num_features: int,
        row_offsets: NDArray[np.int64],
        row_features: NDArray[np.int32],
        row_values: NDArray[np.float64],
        offsets: NDArray[np.int64],
        position_rows: NDArray[np.int32],
        position_labels: NDArray[np.int32],
    ) -> None: ...
    def __call__(
        self, weights: NDArray[np.float64], sequence_weights: NDArray[np.float64]
    ) -> tuple[float, NDArray[np.float64]]:
        """Loss and gradient; state weights (features x labels, flat) come first, then transition weights."""

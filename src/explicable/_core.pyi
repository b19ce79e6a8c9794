"""Types of the compiled core; one section per file of ``cpp/bindings``."""

from array import array
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

# --- task and grounding (cpp/bindings/task.cpp) ---

_Effects = list[tuple[list[int], list[int], list[int]]]  # condition, adds, deletes

AUXILIARY: int

class TaskData: ...

class Task(TaskData):
    @staticmethod
    def from_arrays(
        variable_facts: Sequence[Sequence[int]],
        preconditions: Sequence[Sequence[int]],
        adds: Sequence[Sequence[int]],
        deletes: Sequence[Sequence[int]],
        costs: Sequence[int],
        effects: Sequence[Sequence[tuple[Sequence[int], Sequence[int], Sequence[int]]]],
        initial: Sequence[int],
        goal: Sequence[int],
        goal_reachable: bool = True,
    ) -> Task: ...
    @property
    def num_facts(self) -> int: ...
    @property
    def num_operators(self) -> int: ...
    @property
    def num_variables(self) -> int: ...
    @property
    def num_words(self) -> int: ...
    @property
    def initial(self) -> list[int]: ...
    @property
    def goal(self) -> list[int]: ...
    @property
    def goal_reachable(self) -> bool: ...
    def fact_arguments(self, fact: int) -> list[int]: ...
    def fact_predicate(self, fact: int) -> int: ...
    def fact_variable(self, fact: int) -> int: ...
    def operator_arguments(self, operator: int) -> list[int]: ...
    def operator_schema(self, operator: int) -> int: ...
    def preconditions(self, operator: int) -> list[int]: ...
    def adds(self, operator: int) -> list[int]: ...
    def deletes(self, operator: int) -> list[int]: ...
    def effects(self, operator: int) -> _Effects: ...
    def cost(self, operator: int) -> int: ...
    def variable_facts(self, variable: int) -> list[int]: ...
    def find_fact(self, predicate: int, arguments: Sequence[int]) -> int: ...
    def find_operators(self, schema: int, arguments: Sequence[int]) -> list[int]: ...
    def pack(self, facts: Sequence[int]) -> bytes: ...
    def true_facts(self, state: bytes) -> list[int]: ...
    def holds(self, state: bytes, facts: Sequence[int]) -> bool: ...
    def successor(self, state: bytes, operator: int) -> bytes: ...
    def is_applicable(self, state: bytes, operator: int) -> bool: ...
    def applicable(self, state: bytes) -> list[int]: ...
    def array(self, name: str) -> memoryview: ...

def ground(
    structure: array[int],
    initial: Sequence[array[int]],
    num_initial: Sequence[int],
    function_arguments: Sequence[array[int]],
    function_values: Sequence[array[int]],
    memory_limit_bytes: int,
) -> Task: ...

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

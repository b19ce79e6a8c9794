"""Sequences of named features as flat integer arrays, equal positions stored once."""

import math
from array import array
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from explicable.errors import UsageError

Features: TypeAlias = Iterable[str] | Mapping[str, float]
"""What is known of one position: names of features that are on, or a value for each name."""

FeatureSequence: TypeAlias = Iterable[Features]
"""One sequence: features position by position."""


@dataclass(frozen=True, slots=True)
class EncodedSequences:
    """Sequences as the compiled core reads them.

    Attributes
    ----------
    row_offsets, row_features, row_values
        Distinct positions: row ``r`` has the features ``row_features[row_offsets[r]:row_offsets[r + 1]]``;
        ``row_values`` is empty if all values are 1. int64, int32, float64.
    offsets
        Sequence ``s`` is made of the positions ``offsets[s]`` up to ``offsets[s + 1]``. int64.
    position_rows
        Row of each position. int32.
    """

    row_offsets: NDArray[np.int64]
    row_features: NDArray[np.int32]
    row_values: NDArray[np.float64]
    offsets: NDArray[np.int64]
    position_rows: NDArray[np.int32]

    @property
    def num_sequences(self) -> int:
        """Number of sequences, empty ones included."""
        return len(self.offsets) - 1

    @property
    def lengths(self) -> NDArray[np.int64]:
        """Number of positions of each sequence."""
        return np.diff(self.offsets)


class FeatureEncoder:
    """Gathers sequences, then numbers their features.

    A feature that is named twice at one position has twice the value. The result does not depend on the order
    in which a position's features are given.

    Examples
    --------
    >>> encoder = FeatureEncoder()
    >>> encoder.add_all([[["move", "near"], ["visit"], ["near", "move"]]])
    >>> names = encoder.feature_names()
    >>> names
    ('move', 'near', 'visit')
    >>> encoder.encode(names).position_rows.tolist()
    [0, 1, 0]
    """

    def __init__(self) -> None:
        self._row_of: dict[tuple[object, ...], int] = {}
        self._id_of: dict[str, int] = {}  # by first appearance
        self._names: list[str] = []
        self._row_offsets = array("q", [0])
        self._row_features = array("i")
        self._row_values = array("d")
        self._position_rows = array("i")
        self._offsets = array("q", [0])

    def add_all(self, sequences: Iterable[FeatureSequence]) -> None:
        """Add sequences; an iterator is read once, so no more than one sequence need exist at a time.

        Raises
        ------
        UsageError
            If something is no sequence of collections of features; names sequence and position.
        """
        for number, sequence in enumerate(sequences, start=len(self._offsets) - 1):
            start = len(self._position_rows)
            try:
                if isinstance(sequence, (str, Mapping)):
                    raise UsageError("it must be a list of positions")
                for position in sequence:
                    self._position_rows.append(self._row(position))
            except (TypeError, UsageError) as error:
                place = f"sequence {number}, position {len(self._position_rows) - start}"
                raise UsageError(f"{place}: {error}") from error
            self._offsets.append(len(self._position_rows))

    def feature_names(self) -> tuple[str, ...]:
        """Return all features seen, sorted."""
        return tuple(sorted(self._names))

    def encode(self, feature_names: Sequence[str]) -> EncodedSequences:
        """Return the sequences with features numbered as in `feature_names`; others are left out."""
        final_ids = {name: number for number, name in enumerate(feature_names)}
        renumbered = np.array([final_ids.get(name, -1) for name in self._names], dtype=np.int32)
        features = renumbered[np.array(self._row_features, dtype=np.int32)]
        known = features >= 0
        num_known_before = np.concatenate([[0], np.cumsum(known)])
        values = np.array(self._row_values, dtype=np.float64)[known]
        return EncodedSequences(
            row_offsets=num_known_before[np.array(self._row_offsets, dtype=np.int64)].astype(np.int64),
            row_features=features[known],
            row_values=values[:0] if (values == 1.0).all() else values,
            offsets=np.array(self._offsets, dtype=np.int64),
            position_rows=np.array(self._position_rows, dtype=np.int32),
        )

    def _row(self, position: Features) -> int:
        if isinstance(position, str):
            raise UsageError(f"features must be a collection of names, not the string {position!r}")
        # The order in which features are named must not show in the result: hence sorted.
        key = tuple(sorted(position.items() if isinstance(position, Mapping) else position))
        row = self._row_of.get(key)
        return self._add_row(key) if row is None else row

    def _add_row(self, key: tuple[object, ...]) -> int:
        totals: dict[int, float] = {}
        for item in key:
            name, value = item if isinstance(item, tuple) and len(item) == 2 else (item, 1.0)
            if not isinstance(name, str):
                raise UsageError(f"a feature's name must be a string, not {name!r}")
            feature = self._id_of.setdefault(name, len(self._names))
            if feature == len(self._names):
                self._names.append(name)
            try:
                totals[feature] = totals.get(feature, 0.0) + float(value)
            except (TypeError, ValueError):
                raise UsageError(f"feature {name!r} has the value {value!r}, which is no number") from None
            if not math.isfinite(totals[feature]):
                raise UsageError(f"feature {name!r} has the value {value!r}; it must be finite")
        self._row_features.extend(totals)
        self._row_values.extend(totals.values())
        self._row_offsets.append(len(self._row_features))
        # Of equal strings only one is kept in memory.
        shared = tuple(self._names[self._id_of[item]] if isinstance(item, str) else item for item in key)
        self._row_of[shared] = len(self._row_of)
        return self._row_of[shared]


def encode_labels(
    labels: Iterable[Iterable[object]], class_ids: Mapping[object, int], lengths: NDArray[np.int64]
) -> NDArray[np.int32]:
    """Return the numbers of labels; ``None`` (unobserved, not clamped) becomes -1.

    Parameters
    ----------
    labels
        A label or ``None`` for each position of each sequence.
    class_ids
        Number of each label.
    lengths
        Length that each sequence must have.

    Raises
    ------
    UsageError
        If a length is wrong or a label has no number.

    Examples
    --------
    >>> encode_labels([["a", None], ["b"]], {"a": 0, "b": 1}, np.array([2, 1])).tolist()
    [0, -1, 1]
    """
    encoded = array("i")
    num_sequences = 0
    for number, sequence in enumerate(labels):
        num_sequences += 1
        start = len(encoded)
        for label in sequence:
            if label is None:
                encoded.append(-1)
            elif label in class_ids:
                encoded.append(class_ids[label])
            else:
                raise UsageError(f"sequence {number}: label {label!r} is none of {list(class_ids)}")
        if number < len(lengths) and len(encoded) - start != lengths[number]:
            raise UsageError(
                f"sequence {number} has {lengths[number]} positions but {len(encoded) - start} labels"
            )
    if num_sequences != len(lengths):
        raise UsageError(f"there are {len(lengths)} sequences but labels for {num_sequences}")
    return np.array(encoded, dtype=np.int32)

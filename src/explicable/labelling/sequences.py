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
    >>> encoder.add_all([[["move", "near"], ["visit"], {"near": 1.0, "move": 1.0}]])
    >>> names = encoder.feature_names()
    >>> names
    ('move', 'near', 'visit')
    >>> encoder.encode(names).position_rows.tolist()
    [0, 1, 0]
    """

    def __init__(self) -> None:
        self._row_of_raw: dict[tuple[object, ...], int] = {}
        self._row_of_canonical: dict[tuple[object, ...], int] = {}
        self._rows: list[tuple[tuple[str, ...], tuple[float, ...] | None]] = []
        self._position_rows = array("i")
        self._offsets = array("q", [0])

    def add_all(self, sequences: Iterable[FeatureSequence]) -> None:
        """Add sequences; an iterator is read once, so no more than one sequence need exist at a time."""
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
        return tuple(sorted({name for names, _ in self._rows for name in names}))

    def encode(self, feature_names: Sequence[str]) -> EncodedSequences:
        """Return the sequences with features numbered as in `feature_names`; others are left out."""
        ids = {name: number for number, name in enumerate(feature_names)}
        features, offsets = array("i"), array("q", [0])
        values: array[float] | None = array("d") if any(values for _, values in self._rows) else None
        for names, row_values in self._rows:
            known = [k for k, name in enumerate(names) if name in ids]
            features.extend(ids[names[k]] for k in known)
            if values is not None:
                values.extend(1.0 if row_values is None else row_values[k] for k in known)
            offsets.append(len(features))
        return EncodedSequences(
            row_offsets=np.array(offsets, dtype=np.int64),
            row_features=np.array(features, dtype=np.int32),
            row_values=np.array([] if values is None else values, dtype=np.float64),
            offsets=np.array(self._offsets, dtype=np.int64),
            position_rows=np.array(self._position_rows, dtype=np.int32),
        )

    def _row(self, position: Features) -> int:
        if isinstance(position, str):
            raise UsageError(f"features must be a collection of names, not the string {position!r}")
        raw: tuple[object, ...] = (
            tuple(position.items()) if isinstance(position, Mapping) else tuple(position)
        )
        row = self._row_of_raw.get(raw)
        if row is None:
            row = self._row_of_raw[raw] = self._add_row(raw)
        return row

    def _add_row(self, raw: tuple[object, ...]) -> int:
        totals: dict[str, float] = {}
        for item in raw:
            name, value = item if isinstance(item, tuple) and len(item) == 2 else (item, 1.0)
            if not isinstance(name, str):
                raise UsageError(f"a feature's name must be a string, not {name!r}")
            try:
                totals[name] = totals.get(name, 0.0) + float(value)
            except (TypeError, ValueError):
                raise UsageError(f"feature {name!r} has the value {value!r}, which is no number") from None
            if not math.isfinite(totals[name]):
                raise UsageError(f"feature {name!r} has the value {value!r}; it must be finite")
        names = tuple(sorted(totals))
        values = tuple(totals[name] for name in names)
        row = (names, None if all(value == 1.0 for value in values) else values)
        known = self._row_of_canonical.setdefault(row, len(self._rows))
        if known == len(self._rows):
            self._rows.append(row)
        return known


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

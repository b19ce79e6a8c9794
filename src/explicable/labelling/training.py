"""The training problem of a conditional random field: the penalised loss of labelled sequences."""

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explicable import _core
from explicable.errors import UsageError
from explicable.labelling.minimising import Optimum, minimise
from explicable.labelling.sequences import EncodedSequences, FeatureEncoder, FeatureSequence, encode_labels


@dataclass(frozen=True, slots=True)
class Training:
    """Encoded sequences with their penalties, solved as often as one likes with other weights of sequences.

    Attributes
    ----------
    classes, feature_names
        What labels and features were numbered by.
    num_sequences
        Number of sequences.
    loss
        The compiled loss and its gradient.
    l1, l2
        Penalty of each weight.
    max_iterations, tolerance
        When to stop, see `ConditionalRandomField`.
    """

    classes: tuple[Any, ...]
    feature_names: tuple[str, ...]
    num_sequences: int
    loss: _core.SequenceLoss
    l1: NDArray[np.float64]
    l2: NDArray[np.float64]
    max_iterations: int
    tolerance: float

    @classmethod
    def prepare(
        cls,
        sequences: Iterable[FeatureSequence],
        labels: Iterable[Iterable[Any]],
        classes: Sequence[Any] | None,
        feature_scale: Mapping[str, float] | None,
        c1: float,
        c2: float,
        max_iterations: int,
        tolerance: float,
        given: Iterable[Iterable[Any]] | None = None,
    ) -> Self:
        """Check and encode what `ConditionalRandomField.fit` is given, except the sequences' weights.

        Raises
        ------
        UsageError
            As `ConditionalRandomField.fit`, but for the weights.
        """
        _check_number("c1", c1)
        _check_number("c2", c2)
        _check_number("tolerance", tolerance)
        if max_iterations < 1:
            raise UsageError(f"max_iterations must be at least 1, not {max_iterations}")
        encoder = FeatureEncoder()
        encoder.add_all(sequences)
        feature_names = encoder.feature_names()
        encoded = encoder.encode(feature_names)
        if classes is None:
            rows = [list(row) for row in labels]
            labels, classes = rows, _classes_of(rows)
        classes = check_classes(classes)
        label_ids = encode_labels(labels, {label: k for k, label in enumerate(classes)}, encoded.lengths)
        given_ids = None
        if given is not None:
            given_ids = encode_labels(given, {label: k for k, label in enumerate(classes)}, encoded.lengths)
            if ((given_ids >= 0) & (given_ids != label_ids)).any():
                raise UsageError("what is given of a position must be its label")
        if not (label_ids >= 0).any():
            raise UsageError("there is no labelled position to learn from")
        scale = _penalty_scale(feature_names, feature_scale, len(classes))
        return cls(
            classes=classes,
            feature_names=feature_names,
            num_sequences=encoded.num_sequences,
            loss=sequence_loss(encoded, label_ids, len(classes), len(feature_names), given_ids),
            l1=c1 * scale,
            l2=c2 * scale,
            max_iterations=max_iterations,
            tolerance=tolerance,
        )

    def minimise(
        self, sample_weight: ArrayLike | None = None, start: NDArray[np.float64] | None = None
    ) -> Optimum:
        """Find the weights of least penalised loss.

        Parameters
        ----------
        sample_weight
            Weight of each sequence. Default: 1.
        start
            Weights to begin at. Default: zero.

        Raises
        ------
        UsageError
            If a weight is negative or not finite, or their number is wrong.

        Warns
        -----
        ConvergenceWarning
            scikit-learn's, if training stopped before it converged.
        """
        weights = check_sample_weight(sample_weight, self.num_sequences)
        if start is None:
            start = np.zeros(len(self.l2))
        optimum = self._minimise_l1(weights, start) if self.l1.any() else self._minimise_l2(weights, start)
        if not optimum.converged:
            from sklearn.exceptions import ConvergenceWarning

            message = f"training stopped after {optimum.num_iterations} iterations before it converged"
            warnings.warn(message, ConvergenceWarning, stacklevel=3)
        return optimum

    def _smooth_part(
        self, weights: NDArray[np.float64], sample_weight: NDArray[np.float64]
    ) -> tuple[float, NDArray[np.float64]]:
        value, gradient = self.loss(weights, sample_weight)
        gradient += 2.0 * self.l2 * weights
        return value + float(self.l2 @ (weights * weights)), gradient

    def _minimise_l2(self, sample_weight: NDArray[np.float64], start: NDArray[np.float64]) -> Optimum:
        def objective(weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
            return self._smooth_part(weights, sample_weight)

        return minimise(objective, start, max_iterations=self.max_iterations, tolerance=self.tolerance)

    def _minimise_l1(self, sample_weight: NDArray[np.float64], start: NDArray[np.float64]) -> Optimum:
        """Write weights as a difference of two non-negative parts: then the L1 penalty is smooth."""
        size = len(start)

        def objective(parts: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
            value, gradient = self._smooth_part(parts[:size] - parts[size:], sample_weight)
            value += float(self.l1 @ (parts[:size] + parts[size:]))
            return value, np.concatenate([self.l1 + gradient, self.l1 - gradient])

        parts = np.concatenate([np.maximum(start, 0.0), np.maximum(-start, 0.0)])
        optimum = minimise(
            objective, parts, lowest=0.0, max_iterations=self.max_iterations, tolerance=self.tolerance
        )
        weights = optimum.weights[:size] - optimum.weights[size:]
        return Optimum(weights, optimum.objective, optimum.num_iterations, optimum.converged)


def sequence_loss(
    encoded: EncodedSequences,
    labels: NDArray[np.int32],
    num_labels: int,
    num_features: int,
    given: NDArray[np.int32] | None = None,
) -> _core.SequenceLoss:
    """Return the compiled loss: a function of all weights and of the weights of sequences."""
    return _core.SequenceLoss(
        num_labels,
        num_features,
        encoded.row_offsets,
        encoded.row_features,
        encoded.row_values,
        encoded.offsets,
        encoded.position_rows,
        labels,
        given,
    )


def check_classes(classes: Sequence[Any]) -> tuple[Any, ...]:
    """Return the labels as a tuple; there must be two or more, all different, none of them ``None``.

    Raises
    ------
    UsageError
        If they are not.
    """
    labels = tuple(classes)
    if len(labels) < 2:
        raise UsageError(f"at least two labels are needed, not {list(labels)}: name all of them in `classes`")
    if len(set(labels)) != len(labels) or None in labels:
        raise UsageError(f"labels must differ, and None is not a label: {list(labels)}")
    return labels


def check_sample_weight(sample_weight: ArrayLike | None, num_sequences: int) -> NDArray[np.float64]:
    """Return the weights of sequences as an array; 1 each if there are none.

    Raises
    ------
    UsageError
        If their number is wrong, or one is negative or not finite.
    """
    if sample_weight is None:
        return np.ones(num_sequences)
    weights = np.array(sample_weight, dtype=np.float64)
    if weights.shape != (num_sequences,):
        raise UsageError(
            f"sample_weight has the shape {weights.shape}, but there are {num_sequences} sequences"
        )
    if not (np.isfinite(weights) & (weights >= 0)).all():
        raise UsageError("weights of sequences must be finite and at least 0")
    return weights


def _check_number(name: str, value: float) -> None:
    if not 0 <= value <= 1e9:  # beyond, gradients overflow
        raise UsageError(f"{name} must be from 0 to 1e9, not {value}")


def _classes_of(labels: list[list[Any]]) -> list[Any]:
    seen = {label for row in labels for label in row if label is not None}
    try:
        return sorted(seen)
    except TypeError:
        raise UsageError("labels of different types have no order: name them in `classes`") from None


def _penalty_scale(
    feature_names: Sequence[str], feature_scale: Mapping[str, float] | None, num_labels: int
) -> NDArray[np.float64]:
    scales = np.ones(len(feature_names) + num_labels)
    if feature_scale:
        scales[: len(feature_names)] = [feature_scale.get(name, 1.0) for name in feature_names]
    if not (np.isfinite(scales) & (scales >= 0)).all():
        raise UsageError("the scale of a feature's penalty must be finite and at least 0")
    return np.repeat(scales, num_labels)

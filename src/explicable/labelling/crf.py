"""A linear-chain conditional random field with scikit-learn's conventions (method.md, section 3)."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explicable import _core
from explicable.errors import UsageError
from explicable.labelling.minimising import Optimum
from explicable.labelling.sequences import (
    EncodedSequences,
    FeatureEncoder,
    FeatureSequence,
    encode_labels,
)
from explicable.labelling.training import (
    Training,
    check_classes,
    check_sample_weight,
    sequence_loss,
)

Label: TypeAlias = Any
"""Any hashable value; ``None`` is no label but says that a position is unobserved, or not clamped."""

LabelSequences: TypeAlias = Iterable[Iterable[Label | None]]

_NOTHING_CLAMPED = np.empty(0, dtype=np.int32)
_ALL_COUNTED = np.empty(0, dtype=np.uint8)


class ConditionalRandomField:
    r"""Predicts a label for each position of a sequence from features and from the neighbouring labels.

    The score of a labelling is :math:`\sum_t s(y_t | x, t) + T(y_{t-1}, y_t)`; training minimises
    :math:`\sum -\log p(y | x) + c_1 |w|_1 + c_2 |w|_2^2` (no one half, as in CRFsuite) by L-BFGS. There are
    weights for every pair of feature and label and every pair of labels, none for the first or last position.

    Positions labelled ``None`` are unobserved: training sums over their labels. Empty sequences are allowed
    and teach nothing. Features unknown at prediction weigh nothing.

    Parameters
    ----------
    c1, c2
        Weights of the L1 and L2 penalty, at least 0.
    classes
        The labels in order; ties in prediction go to the first. Default: those seen in training, sorted.
        Must be given if only one label occurs in training.
    feature_scale
        Factor by which a feature's penalties are multiplied, 1 where missing. Features that stand for a
        whole orbit of a permutation group have the size of the orbit here; traces then have the size of the
        group as weight.
    max_iterations
        Upper limit of L-BFGS iterations.
    tolerance
        Training stops when one iteration improves the objective by less than this fraction.

    Attributes
    ----------
    classes_ : tuple
        The labels in order.
    feature_names_ : tuple of str
        Features seen in training, sorted.
    state_weights_ : ndarray, features x labels
    transition_weights_ : ndarray, label before x label after
    objective_ : float
        Penalised loss reached.
    num_iterations_ : int
    converged_ : bool

    Examples
    --------
    >>> X = [[["near"], ["far"]], [["far"], ["near"], ["near"]]]
    >>> y = [[True, False], [False, True, None]]
    >>> crf = ConditionalRandomField(c2=0.1).fit(X, y)
    >>> crf.predict([[["near"], ["far"], ["far"]]])
    [[True, False, False]]
    """

    classes_: tuple[Label, ...]
    feature_names_: tuple[str, ...]
    state_weights_: NDArray[np.float64]
    transition_weights_: NDArray[np.float64]
    objective_: float
    num_iterations_: int
    converged_: bool

    def __init__(
        self,
        c1: float = 0.0,
        c2: float = 1.0,
        classes: Sequence[Label] | None = None,
        feature_scale: Mapping[str, float] | None = None,
        max_iterations: int = 1000,
        tolerance: float = 1e-10,
    ) -> None:
        self.c1 = c1
        self.c2 = c2
        self.classes = classes
        self.feature_scale = feature_scale
        self.max_iterations = max_iterations
        self.tolerance = tolerance

    @classmethod
    def from_weights(
        cls,
        classes: Sequence[Label],
        feature_names: Sequence[str],
        state_weights: ArrayLike,
        transition_weights: ArrayLike,
    ) -> Self:
        """Return a model with given weights, ready to predict.

        Raises
        ------
        UsageError
            If shapes do not fit, names repeat, or a weight is not finite.

        Examples
        --------
        >>> crf = ConditionalRandomField.from_weights("ab", ["near"], [[1, 0]], [[0, 0], [0, 0]])
        >>> crf.predict([[["near"], []]])
        [['a', 'a']]
        """
        model = cls(classes=classes)
        model.classes_ = check_classes(classes)
        model.feature_names_ = tuple(feature_names)
        if len(set(model.feature_names_)) != len(model.feature_names_):
            raise UsageError("a feature is named twice")
        num_labels = len(model.classes_)
        model.state_weights_ = _check_weights(state_weights, (len(model.feature_names_), num_labels))
        model.transition_weights_ = _check_weights(transition_weights, (num_labels, num_labels))
        return model

    def get_params(self, deep: bool = True) -> dict[str, Any]:  # noqa: ARG002 - scikit-learn's signature
        """Return the constructor's parameters by name."""
        names = ("c1", "c2", "classes", "feature_scale", "max_iterations", "tolerance")
        return {name: getattr(self, name) for name in names}

    def set_params(self, **params: object) -> Self:
        """Set constructor parameters by name.

        Raises
        ------
        UsageError
            If there is no parameter of a name.
        """
        unknown = params.keys() - self.get_params().keys()
        if unknown:
            raise UsageError(f"a conditional random field has no parameter {', '.join(sorted(unknown))}")
        for name, value in params.items():
            setattr(self, name, value)
        return self

    def __repr__(self) -> str:
        return f"ConditionalRandomField({', '.join(f'{k}={v!r}' for k, v in self.get_params().items())})"

    def __sklearn_tags__(self) -> object:
        from sklearn.utils import Tags, TargetTags

        return Tags(estimator_type=None, target_tags=TargetTags(required=True))

    def fit(
        self,
        X: Iterable[FeatureSequence],
        y: LabelSequences,
        sample_weight: ArrayLike | None = None,
        given: LabelSequences | None = None,
    ) -> Self:
        """Train on labelled sequences; iterators are read once, so that large sets need not exist in memory.

        Parameters
        ----------
        X
            Sequences of positions, each a collection of feature names or a mapping from names to values.
        y
            A label, or ``None`` (unobserved), for each position.
        sample_weight
            Weight of each sequence, at least 0. Default: 1.
        given
            Labels that will be clamped in prediction too, and ``None`` for all other positions: the loss is
            ``-log p(y | X, given)``, so that no weight is spent on what is known beforehand. Default: none.

        Raises
        ------
        UsageError
            If lengths differ, values or weights are not finite, fewer than two labels are known, or no
            position is labelled.
        """
        training = self.prepare(X, y, given)
        return self.adopt(training, training.minimise(sample_weight))

    def prepare(
        self, X: Iterable[FeatureSequence], y: LabelSequences, given: LabelSequences | None = None
    ) -> Training:
        """Return the training problem that `fit` solves, to solve it several times with other weights."""
        return Training.prepare(
            X,
            y,
            self.classes,
            self.feature_scale,
            self.c1,
            self.c2,
            self.max_iterations,
            self.tolerance,
            given,
        )

    def adopt(self, training: Training, optimum: Optimum) -> Self:
        """Take over the weights that were found for a training problem; returns the model."""
        num_labels = len(training.classes)
        self.classes_ = training.classes
        self.feature_names_ = training.feature_names
        self.state_weights_ = optimum.weights[: -num_labels * num_labels].reshape(-1, num_labels)
        self.transition_weights_ = optimum.weights[-num_labels * num_labels :].reshape(-1, num_labels)
        self.objective_ = optimum.objective
        self.num_iterations_ = optimum.num_iterations
        self.converged_ = optimum.converged
        return self

    def predict(self, X: Iterable[FeatureSequence], clamp: LabelSequences | None = None) -> list[list[Label]]:
        """Return the most probable labels of each sequence; ties go to the label that comes first.

        Parameters
        ----------
        X
            Sequences, as in `fit`.
        clamp
            For each position the label that it must have, or ``None``.
        """
        return [
            [self.classes_[label] for label in _core.viterbi(state, self.transition_weights_, clamped)]
            for state, clamped in self._chains(X, clamp)
        ]

    def predict_marginals(
        self, X: Iterable[FeatureSequence], clamp: LabelSequences | None = None
    ) -> list[NDArray[np.float64]]:
        """Return the probability of each label (columns, as in `classes_`) at each position (rows).

        Parameters as in `predict`.
        """
        return [
            _core.marginals(state, self.transition_weights_, clamped)
            for state, clamped in self._chains(X, clamp)
        ]

    def predict_counts(
        self,
        X: Iterable[FeatureSequence],
        empty: Label,
        clamp: LabelSequences | None = None,
        counted: Iterable[Sequence[bool]] | None = None,
    ) -> list[NDArray[np.float64]]:
        """Return, for each sequence, the distribution of the number of positions whose label is not `empty`.

        Parameters
        ----------
        X, clamp
            As in `predict`.
        empty
            The label that is not counted.
        counted
            For each position whether it counts. Default: all do.

        Returns
        -------
        list of ndarray
            Entry ``k`` is the probability that ``k`` positions have another label.

        Raises
        ------
        UsageError
            If there is no such label, or not one flag for each position.

        Examples
        --------
        >>> crf = ConditionalRandomField.from_weights("ab", ["near"], [[0, 0]], [[0, 0], [0, 0]])
        >>> crf.predict_counts([[["near"], []]], empty="b")[0].tolist()
        [0.25, 0.5, 0.25]
        """
        empty_id = self._class_ids().get(empty)
        if empty_id is None:
            raise UsageError(f"label {empty!r} is none of {list(self.classes_)}")
        chains = list(self._chains(X, clamp))
        flags = [_ALL_COUNTED] * len(chains)
        if counted is not None:
            flags = [_flags(row) for row in counted]
            if [len(row) for row in flags] != [len(state) for state, _ in chains]:
                raise UsageError("`counted` needs one flag for each position of each sequence")
        return [
            _core.count_distribution(state, self.transition_weights_, clamped, empty_id, row)
            for (state, clamped), row in zip(chains, flags, strict=True)
        ]

    def score(
        self, X: Iterable[FeatureSequence], y: LabelSequences, sample_weight: ArrayLike | None = None
    ) -> float:
        """Return the fraction of labelled positions that `predict` gets right.

        Raises
        ------
        UsageError
            If lengths differ, no position is labelled, or the model is not trained.
        """
        predicted = self.predict(X)
        answers = [list(row) for row in y]
        if [len(row) for row in answers] != [len(row) for row in predicted]:
            raise UsageError("there must be one label, or None, for each position of each sequence")
        weights = check_sample_weight(sample_weight, len(predicted))
        right = total = 0.0
        for weight, guesses, truths in zip(weights, predicted, answers, strict=True):
            for guess, truth in zip(guesses, truths, strict=True):
                if truth is not None:
                    right += weight * (guess == truth)
                    total += weight
        if total == 0:
            raise UsageError("there is no labelled position to score")
        return float(right / total)

    def log_likelihood(
        self, X: Iterable[FeatureSequence], y: LabelSequences, sample_weight: ArrayLike | None = None
    ) -> float:
        """Return the sum of log p(labels | sequence); unobserved positions are summed over."""
        encoded = self._encode(X)
        labels = encode_labels(y, self._class_ids(), encoded.lengths)
        loss = sequence_loss(encoded, labels, len(self.classes_), len(self.feature_names_))
        weights = np.concatenate([self.state_weights_.ravel(), self.transition_weights_.ravel()])
        value, _ = loss(weights, check_sample_weight(sample_weight, encoded.num_sequences))
        return -value

    def _class_ids(self) -> dict[Label, int]:
        if not hasattr(self, "classes_"):
            raise UsageError("the model is not trained: call fit first")
        return {label: number for number, label in enumerate(self.classes_)}

    def _encode(self, sequences: Iterable[FeatureSequence]) -> EncodedSequences:
        self._class_ids()
        encoder = FeatureEncoder()
        encoder.add_all(sequences)
        return encoder.encode(self.feature_names_)

    def _chains(
        self, sequences: Iterable[FeatureSequence], clamp: LabelSequences | None
    ) -> Iterable[tuple[NDArray[np.float64], NDArray[np.int32]]]:
        """Yield state scores and clamped labels of each sequence."""
        encoded = self._encode(sequences)
        rows = _core.state_scores(
            encoded.row_offsets, encoded.row_features, encoded.row_values, self.state_weights_
        )
        clamped = None if clamp is None else encode_labels(clamp, self._class_ids(), encoded.lengths)
        for start, end in zip(encoded.offsets[:-1], encoded.offsets[1:], strict=True):
            state = rows[encoded.position_rows[start:end]]
            yield state, _NOTHING_CLAMPED if clamped is None else clamped[start:end]


def _check_weights(weights: ArrayLike, shape: tuple[int, int]) -> NDArray[np.float64]:
    matrix = (
        np.array(weights, dtype=np.float64).reshape(shape) if 0 in shape else np.array(weights, np.float64)
    )
    if matrix.shape != shape:
        raise UsageError(f"weights have the shape {matrix.shape}; {shape} is needed")
    if not np.isfinite(matrix).all():
        raise UsageError("a weight is not finite")
    return matrix


def _flags(row: Iterable[bool]) -> NDArray[np.uint8]:
    return np.array([bool(flag) for flag in row], dtype=np.uint8)

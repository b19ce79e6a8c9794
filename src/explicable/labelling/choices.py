"""What a person chooses next: a conditional logit over the alternatives of each situation.

McFadden, *Conditional Logit Analysis of Qualitative Choice Behavior*, 1974: an alternative with features x is
chosen with probability proportional to exp(w . x). Only differences between alternatives matter, so a feature
that is the same for all of them has no effect. The weights are those of least -log p + c2 |w|^2.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explicable import _core
from explicable.errors import UsageError
from explicable.labelling.minimising import minimise
from explicable.labelling.sequences import EncodedSequences, FeatureEncoder, Features
from explicable.labelling.training import check_sample_weight


@dataclass(frozen=True, slots=True)
class ChoiceQuality:
    """How well choices were predicted.

    Attributes
    ----------
    num_choices
        How many choices were predicted.
    log_loss
        Mean of -log(probability of what was chosen), in nats.
    uniform_log_loss
        The same for one who thinks all alternatives equally likely.
    accuracy
        Fraction of choices that were the most probable alternative.
    top_k
        Fraction of choices that were among the k most probable, for k = 1, 2, ...
    """

    num_choices: int
    log_loss: float
    uniform_log_loss: float
    accuracy: float
    top_k: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ChoiceModel:
    """A trained conditional logit.

    Attributes
    ----------
    feature_names
        Sorted.
    weights
        One a feature.

    Examples
    --------
    >>> situations = [[{"distance": 1}, {"distance": 4}], [{"distance": 3}, {"distance": 2}, {"distance": 5}]]
    >>> model = ChoiceModel.fit(situations, chosen=[0, 1], c2=0.1)
    >>> model.predict(situations)
    [0, 1]
    >>> [round(p, 2) for p in model.predict_probabilities(situations)[0].tolist()]
    [0.98, 0.02]
    """

    feature_names: tuple[str, ...]
    weights: NDArray[np.float64]

    @classmethod
    def fit(
        cls,
        choice_sets: Iterable[Iterable[Features]],
        chosen: Sequence[int],
        *,
        c2: float = 1.0,
        sample_weight: ArrayLike | None = None,
    ) -> Self:
        """Learn from choices.

        Parameters
        ----------
        choice_sets
            For each choice the features of its alternatives: names, or values by name.
        chosen
            Index of the alternative that was chosen, for each choice.
        c2
            Weight of the L2 penalty, at least 0.
        sample_weight
            Weight of each choice. Default: 1.

        Raises
        ------
        UsageError
            If there is nothing to choose from, an index is out of range, or a number is not finite.
        """
        if not (np.isfinite(c2) and c2 >= 0):
            raise UsageError(f"c2 must be finite and at least 0, not {c2}")
        encoder = FeatureEncoder()
        encoder.add_all(choice_sets)
        names = encoder.feature_names()
        encoded = encoder.encode(names)
        picked = _check_chosen(encoded, chosen)
        weights = check_sample_weight(sample_weight, len(picked))
        alternative_weights = np.repeat(weights, encoded.lengths)

        def objective(w: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
            log_p = _log_probabilities(encoded, w)
            surplus = alternative_weights * np.exp(log_p)
            surplus[picked] -= weights
            gradient = _feature_sums(encoded, surplus, len(names)) + 2 * c2 * w
            return float(c2 * (w @ w) - weights @ log_p[picked]), gradient

        return cls(names, minimise(objective, np.zeros(len(names))).weights)

    def predict_probabilities(self, choice_sets: Iterable[Iterable[Features]]) -> list[NDArray[np.float64]]:
        """Return the probability of each alternative of each choice; unknown features weigh nothing."""
        encoded = self._encode(choice_sets)
        probabilities = np.exp(_log_probabilities(encoded, self.weights))
        return np.split(probabilities, encoded.offsets[1:-1]) if encoded.num_sequences else []

    def predict(self, choice_sets: Iterable[Iterable[Features]]) -> list[int]:
        """Return the most probable alternative of each choice; ties go to the first."""
        return [int(np.argmax(p)) for p in self.predict_probabilities(choice_sets)]

    def quality(
        self, choice_sets: Iterable[Iterable[Features]], chosen: Sequence[int], *, largest_k: int = 3
    ) -> ChoiceQuality:
        """Compare predictions with choices, best with ones that the model was not trained on."""
        encoded = self._encode(choice_sets)
        picked = _check_chosen(encoded, chosen)
        log_p = _log_probabilities(encoded, self.weights)
        tables = np.split(log_p, encoded.offsets[1:-1])
        # Alternatives before the chosen one in order of probability; of equals the first comes first.
        ranks = np.array(
            [
                (table > table[choice]).sum() + (table[:choice] == table[choice]).sum()
                for table, choice in zip(tables, chosen, strict=True)
            ]
        )
        return ChoiceQuality(
            num_choices=len(ranks),
            log_loss=float(-log_p[picked].mean()),
            uniform_log_loss=float(np.log(encoded.lengths).mean()),
            accuracy=float((ranks == 0).mean()),
            top_k=tuple(float((ranks < k).mean()) for k in range(1, largest_k + 1)),
        )

    @classmethod
    def from_weights(cls, weights: Mapping[str, float]) -> Self:
        """Return a model with given weights.

        Raises
        ------
        UsageError
            If a weight is not finite.

        Examples
        --------
        >>> ChoiceModel.from_weights({"near": 2.0}).predict([[["far"], ["near"]]])
        [1]
        """
        names = tuple(sorted(weights))
        values = np.array([weights[name] for name in names], dtype=np.float64)
        if not np.isfinite(values).all():
            raise UsageError("a weight is not finite")
        return cls(names, values)

    def _encode(self, choice_sets: Iterable[Iterable[Features]]) -> EncodedSequences:
        encoder = FeatureEncoder()
        encoder.add_all(choice_sets)
        encoded = encoder.encode(self.feature_names)
        _check_alternatives(encoded)
        return encoded


def _check_alternatives(encoded: EncodedSequences) -> None:
    empty = np.flatnonzero(encoded.lengths == 0)
    if empty.size:
        raise UsageError(f"choice {empty[0]} has no alternatives")


def _check_chosen(encoded: EncodedSequences, chosen: Sequence[int]) -> NDArray[np.int64]:
    """Return the places of the chosen among all alternatives."""
    _check_alternatives(encoded)
    picked = np.array(chosen)
    if picked.shape != (encoded.num_sequences,) or not picked.size or picked.dtype.kind not in "iu":
        raise UsageError(
            f"one index is needed for each of {encoded.num_sequences} choices, and there must be one"
        )
    if not ((picked >= 0) & (picked < encoded.lengths)).all():
        raise UsageError("the index of a chosen alternative is out of range")
    places: NDArray[np.int64] = encoded.offsets[:-1] + picked
    return places


def _log_probabilities(encoded: EncodedSequences, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Log-probability of every alternative of every choice, one after the other."""
    if len(encoded.position_rows) == 0:
        return np.empty(0)
    rows = _core.state_scores(
        encoded.row_offsets, encoded.row_features, encoded.row_values, weights.reshape(-1, 1)
    )
    scores: NDArray[np.float64] = rows[encoded.position_rows, 0]
    starts, lengths = encoded.offsets[:-1], encoded.lengths
    scores -= np.repeat(np.maximum.reduceat(scores, starts), lengths)
    scores -= np.repeat(np.log(np.add.reduceat(np.exp(scores), starts)), lengths)
    return scores


def _feature_sums(
    encoded: EncodedSequences, amounts: NDArray[np.float64], num_features: int
) -> NDArray[np.float64]:
    """Sum over alternatives of amount times value, for each feature."""
    num_rows = len(encoded.row_offsets) - 1
    row_amounts = np.bincount(encoded.position_rows, amounts, num_rows)
    terms = np.repeat(row_amounts, np.diff(encoded.row_offsets)).astype(np.float64)
    if encoded.row_values.size:
        terms *= encoded.row_values
    return np.bincount(encoded.row_features, terms, num_features).astype(np.float64)

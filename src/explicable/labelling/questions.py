"""What to ask next: the steps and plans whose labels would teach a labeller most.

The measure is the mutual information between a label and the model, over an ensemble from `fit_bootstrap`:
the entropy of the mean prediction less the mean entropy of the predictions (Houlsby et al., *Bayesian Active
Learning for Classification and Preference Learning*, 2011). Where all models agree that a step is a toss-up
it is 0: asking would not help.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explicable.errors import UsageError
from explicable.labelling.crf import ConditionalRandomField, LabelSequences
from explicable.labelling.sequences import FeatureSequence


@dataclass(frozen=True, slots=True)
class Question:
    """A plan to ask about.

    Attributes
    ----------
    plan
        Its number among those that were ranked.
    information
        Sum over its steps, in nats: an upper bound of what all its labels would tell, as they overlap.
    by_step
        Information of each step; 0 where nobody may be asked.
    """

    plan: int
    information: float
    by_step: NDArray[np.float64]


def rank_questions(
    models: Sequence[ConditionalRandomField],
    X: Iterable[FeatureSequence],
    *,
    clamp: LabelSequences | None = None,
    may_ask: Iterable[Sequence[bool]] | None = None,
    per_step: bool = False,
) -> list[Question]:
    """Rank unlabelled plans, most informative first; ties keep their order.

    Parameters
    ----------
    models
        At least two models with the same labels, such as `fit_bootstrap` returns.
    X
        Features of the steps of each plan.
    clamp
        Labels that are already known, as in `ConditionalRandomField.predict`.
    may_ask
        Whether one may ask about each step. Default: about all. Clamped steps give no information anyway.
    per_step
        Rank by the mean over the steps that one may ask about instead of their sum: for studies that pay by
        the question rather than by the plan.

    Raises
    ------
    UsageError
        If there are fewer than two models, their labels differ, or `may_ask` does not fit the plans.

    Examples
    --------
    >>> zero = [[0, 0], [0, 0]]
    >>> one = ConditionalRandomField.from_weights([False, True], ["odd", "new"], [[2, 0], [0, 3]], zero)
    >>> two = ConditionalRandomField.from_weights([False, True], ["odd", "new"], [[2, 0], [3, 0]], zero)
    >>> [question.plan for question in rank_questions([one, two], [[["odd"]], [["new"], ["odd"]]])]
    [1, 0]
    """
    if len(models) < 2 or len({model.classes_ for model in models}) > 1:
        raise UsageError("ranking questions takes at least two models with the same labels")
    plans = [list(features) for features in X]
    clamped = None if clamp is None else [list(row) for row in clamp]
    tables = [model.predict_marginals(plans, clamped) for model in models]
    flags = [[True] * len(plan) for plan in plans] if may_ask is None else [list(row) for row in may_ask]
    if [len(row) for row in flags] != [len(plan) for plan in plans]:
        raise UsageError("`may_ask` needs one flag for each step of each plan")
    questions = []
    for number, row in enumerate(flags):
        by_step = label_information(np.array([table[number] for table in tables])) * np.array(
            row, dtype=float
        )
        share = max(sum(row), 1) if per_step else 1
        questions.append(Question(number, float(by_step.sum()) / share, by_step))
    return sorted(questions, key=lambda question: -question.information)


def label_information(probabilities: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mutual information, in nats, between each step's label and the model.

    Parameters
    ----------
    probabilities
        models x steps x labels.

    Examples
    --------
    >>> label_information(np.array([[[1.0, 0.0], [0.5, 0.5]], [[0.0, 1.0], [0.5, 0.5]]])).round(3).tolist()
    [0.693, 0.0]
    """
    mean = np.mean(probabilities, axis=0)
    information: NDArray[np.float64] = _entropy(mean) - np.mean(_entropy(probabilities), axis=0)
    return information.clip(min=0.0)


def _entropy(probabilities: NDArray[np.float64]) -> NDArray[np.float64]:
    logarithms = np.log(np.where(probabilities > 0, probabilities, 1.0))
    return -np.asarray((probabilities * logarithms).sum(axis=-1))

"""The labeller adapted to the person at work: a few steps of training on the answers given so far.

It minimises, from the present weights w0 on,

    -log p(answers | w) + strength * |w - w0|^2,

a Gaussian prior centred at what was learnt from others. The change is bounded three ways: by the prior, by
so many iterations of L-BFGS, and by so much of a change of each weight.
"""

from collections.abc import Sequence
from itertools import chain
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.labelling import Labeller
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.features import TeamFeatures
from explicable.labelling.minimising import minimise
from explicable.labelling.sequences import EncodedSequences, encode_labels
from explicable.labelling.training import sequence_loss
from explicable.model.problem import GroundAtom

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def adapt(
    labeller: Labeller,
    features: TeamFeatures,
    actions: Sequence[GroundAtom],
    answers: Sequence[bool | None],
    *,
    strength: float = 1.0,
    max_iterations: int = 5,
    max_change: float = 1.0,
) -> Labeller:
    """Return the labeller after the answers of one person to the steps of a game.

    Parameters
    ----------
    labeller
        What was learnt from others; its bootstrap stays as it is.
    features
        Of the game's team task.
    actions, answers
        The steps, and what the person said of each; None: not asked. Human steps are explicable.
    strength
        Weight of the prior, above 0: the larger, the less is learnt from one game.
    max_iterations
        Of L-BFGS, at least 1: bounds the time.
    max_change
        Most that a weight may change, in log odds.

    Raises
    ------
    UsageError
        If a number is out of its range, or there is not one answer a step.
    PlanError
        If a step is not possible.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground_team
    >>> zero = ConditionalRandomField.from_weights((True, False), ["step: move"], [[0, 0]], [[0, 0], [0, 0]])
    >>> features = TeamFeatures(ground_team(encode(World(("@.*",)))))
    >>> move = ("move", "r1", "c-0-0", "c-0-1")
    >>> adapted = adapt(Labeller(zero, schemas=["move"]), features, [move], [False])
    >>> adapted.label(features, [move]).labels
    (False,)
    """
    import numpy as np

    if not (strength > 0 and max_iterations >= 1 and max_change >= 0):
        raise UsageError("strength must be above 0, max_iterations at least 1, max_change at least 0")
    if len(actions) != len(answers):
        raise UsageError(f"{len(answers)} answers for {len(actions)} steps")
    if all(answer is None for answer in answers):
        return labeller
    execution = features.task.execute(actions)
    rows = labeller.familiar_features(features.extract(execution.operators, execution.states))
    labels = [
        True if features.tables.is_human(operator) else answer
        for operator, answer in zip(execution.operators, answers, strict=True)
    ]
    model = labeller.model
    seen, encoded = _encode(rows, model.feature_names_)
    known = encode_labels([labels], {label: i for i, label in enumerate(model.classes_)}, encoded.lengths)
    loss = sequence_loss(encoded, known, len(model.classes_), len(seen))
    start = np.concatenate([model.state_weights_[seen].ravel(), model.transition_weights_.ravel()])
    once = np.ones(1)

    def objective(change: "NDArray[np.float64]") -> "tuple[float, NDArray[np.float64]]":
        value, gradient = loss(start + change, once)
        return value + strength * float(change @ change), gradient + 2.0 * strength * change

    change = minimise(objective, np.zeros_like(start), max_iterations=max_iterations).weights
    weights = start + np.clip(change, -max_change, max_change)
    num_seen = len(seen) * len(model.classes_)
    state_weights = model.state_weights_.copy()
    state_weights[seen] = weights[:num_seen].reshape(len(seen), -1)
    transition_weights = weights[num_seen:].reshape(model.transition_weights_.shape)
    adapted = ConditionalRandomField.from_weights(
        model.classes_, model.feature_names_, state_weights, transition_weights
    )
    return Labeller(adapted, labeller.bootstrap, labeller.schemas, labeller.summary)


def _encode(
    rows: Sequence[Sequence[str]], feature_names: Sequence[str]
) -> "tuple[NDArray[np.intp], EncodedSequences]":
    """Encode one sequence by those features of a model that occur in it; no other weight would change.

    Returns
    -------
    tuple of (numbers of the features in the model, encoded sequence)
    """
    import numpy as np

    numbers = {name: number for number, name in enumerate(feature_names)}
    known = [[numbers[name] for name in row if name in numbers] for row in rows]
    seen, features = np.unique(list(chain.from_iterable(known)), return_inverse=True)
    encoded = EncodedSequences(
        row_offsets=np.cumsum([0, *map(len, known)]),
        row_features=features.astype(np.int32),
        row_values=np.empty(0),
        offsets=np.array([0, len(rows)]),
        position_rows=np.arange(len(rows), dtype=np.int32),
    )
    return seen.astype(np.intp), encoded

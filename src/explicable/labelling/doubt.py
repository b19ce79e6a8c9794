"""Doubt of what no trace showed (method page, section 3; docs/adr/0006-doubt.md).

A feature that training never met would weigh nothing, and a step that nobody has seen the like of would be
taken for as explicable as the rest of it. A planner looks for what its labeller likes, and so finds just such
steps. Hence each feature that no trace showed speaks against its step: pessimism in the face of uncertainty,
as in offline reinforcement learning (Jin, Yang & Wang, *Is Pessimism Provably Efficient for Offline RL?*,
2021).
"""

from collections.abc import Collection, Iterable

import numpy as np

from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.learning import Rows
from explicable.labelling.templates import TEMPLATES, UNFAMILIAR

DEFAULT_DOUBT = 0.3
"""Log odds; where labels of plans unlike the traces were predicted best (docs/adr/0006-doubt.md)."""

_OPTIONAL = tuple(f"{template.name}:" for template in TEMPLATES.values() if template.is_optional)


def mark_unfamiliar(rows: Rows, known: Collection[str]) -> Rows:
    """Name each feature that is not known `UNFAMILIAR`, but for those that a step may as well be without.

    Parameters
    ----------
    rows
        Lifted features of each step.
    known
        The features that occurred in training.

    Examples
    --------
    >>> mark_unfamiliar([("step: move", "step: fly", "undoes: move")], {"step: move"})
    [('step: move', 'unfamiliar:', 'undoes: move')]
    """
    return [
        tuple(name if name in known or name.startswith(_OPTIONAL) else UNFAMILIAR for name in row)
        for row in rows
    ]


def with_doubt(models: Iterable[ConditionalRandomField], doubt: float) -> list[ConditionalRandomField]:
    """Return the models with `doubt`, in log odds, as what `UNFAMILIAR` says for their last label.

    Examples
    --------
    >>> model = ConditionalRandomField.from_weights([True, False], [], np.empty((0, 2)), np.zeros((2, 2)))
    >>> with_doubt([model], 0.3)[0].state_weights_.tolist()
    [[0.0, 0.3]]
    """
    doubting = []
    for model in models:
        weights = np.vstack([model.state_weights_, np.zeros(len(model.classes_))])
        weights[-1, -1] = doubt
        names = (*model.feature_names_, UNFAMILIAR)
        doubting.append(
            ConditionalRandomField.from_weights(model.classes_, names, weights, model.transition_weights_)
        )
    return doubting

"""From a trained model to the compiled scorer that a search asks."""

from explicable import _core
from explicable.labelling.augment import ground_symbol_features
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.features import TeamFeatures
from explicable.labelling.learning import Symbols
from explicable.labelling.templates import UNFAMILIAR


def evidence(model: ConditionalRandomField) -> dict[str, float]:
    """Return how much each feature speaks for explicable rather than inexplicable, in log odds.

    Examples
    --------
    >>> zero = [[0, 0], [0, 0]]
    >>> evidence(ConditionalRandomField.from_weights([True, False], ["near"], [[1.0, -0.5]], zero))
    {'near': 1.5}
    """
    difference = model.state_weights_[:, 0] - model.state_weights_[:, 1]
    return dict(zip(model.feature_names_, difference.tolist(), strict=True))


def compile_scorer(
    model: ConditionalRandomField, team: TeamFeatures, *, symbols: Symbols, expected: bool
) -> _core.Scorer:
    """Compile a model of the labels explicable and inexplicable for one team task.

    Lifted features become tables over schemas, arguments and progress; ground symbols one score for each
    operator.
    """
    weights, own = [], []
    spoken = evidence(model)
    if symbols == "lifted":
        for code, weight in zip(team.codes(model.feature_names_), spoken.values(), strict=True):
            if code is not None:
                weights.append((*code, -weight))
    else:
        actions = [team.task.action(operator) or ("",) for operator in range(team.task.num_operators)]
        own = [-sum(spoken.get(name, 0.0) for name in row) for row in ground_symbol_features(actions)]
    transitions = model.transition_weights_.tolist()
    return _core.Scorer(
        team.task.core,
        team.tables,
        weights,
        transitions,
        expected=expected,
        own=own,
        unfamiliar=-spoken.get(UNFAMILIAR, 0.0),
    )

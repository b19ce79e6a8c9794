"""The conditional logit recovers the weights that people choose by."""

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.labelling.choices import ChoiceModel

TRUE_WEIGHTS = {"distance": -0.8, "same room again": -2.0, "on the way": 1.0}


def random_choices(rng, num_choices):
    choice_sets, chosen = [], []
    for _ in range(num_choices):
        alternatives = [
            {
                "distance": float(rng.integers(1, 8)),
                "same room again": float(rng.random() < 0.2),
                "on the way": float(rng.random() < 0.4),
            }
            for _ in range(rng.integers(1, 5))
        ]
        scores = [sum(TRUE_WEIGHTS[name] * value for name, value in a.items()) for a in alternatives]
        choice_sets.append(alternatives)
        chosen.append(int(np.argmax(scores + rng.gumbel(size=len(scores)))))
    return choice_sets, chosen


def test_weights_are_recovered_and_beat_chance_on_held_out_choices():
    rng = np.random.default_rng(4)
    model = ChoiceModel.fit(*random_choices(rng, 1500), c2=0.01)
    for name, weight in zip(model.feature_names, model.weights, strict=True):
        assert weight == pytest.approx(TRUE_WEIGHTS[name], abs=0.25)
    held_out = random_choices(rng, 500)
    quality = model.quality(*held_out)
    assert quality.log_loss < 0.75 * quality.uniform_log_loss
    assert quality.top_k[0] == quality.accuracy <= quality.top_k[1] <= quality.top_k[2] <= 1
    assert quality.accuracy == np.mean(np.array(model.predict(held_out[0])) == held_out[1])
    truth = ChoiceModel.from_weights(TRUE_WEIGHTS).quality(*held_out)
    assert truth.log_loss == pytest.approx(quality.log_loss, abs=0.03)


def test_the_gradient_vanishes_at_the_optimum():
    choice_sets, chosen = random_choices(np.random.default_rng(1), 50)
    weights = np.random.default_rng(2).uniform(0, 2, 50)
    model = ChoiceModel.fit(choice_sets, chosen, c2=0.3, sample_weight=weights)
    gradient = 2 * 0.3 * model.weights
    tables = model.predict_probabilities(choice_sets)
    for alternatives, choice, table, weight in zip(choice_sets, chosen, tables, weights, strict=True):
        assert table.sum() == pytest.approx(1)
        rows = np.array([[a[name] for name in model.feature_names] for a in alternatives])
        gradient += weight * (table @ rows - rows[choice])
    assert gradient == pytest.approx(0, abs=2e-3)


def test_huge_scores_ties_and_unknown_features_have_a_meaning():
    model = ChoiceModel.from_weights({"near": 1e4})
    assert model.predict_probabilities([[["near"], [], {"near": -1e4}]])[0].tolist() == [1.0, 0.0, 0.0]
    assert model.predict([[["never seen"], []]]) == [0]
    assert model.predict_probabilities([]) == []
    assert model.quality([[[], []]], [1]).top_k == (0.0, 1.0, 1.0)
    nothing = ChoiceModel.fit([[[], []]], [0])
    assert nothing.predict_probabilities([[["x"], ["y"]]])[0].tolist() == [0.5, 0.5]


@pytest.mark.parametrize(
    ("choice_sets", "chosen", "options"),
    [
        ([[["a"]]], [1], {}),
        ([[["a"]]], [-1], {}),
        ([[["a"]]], [0, 0], {}),
        ([[["a"]]], [0.0], {}),
        ([], [], {}),
        ([[]], [0], {}),
        ([[{"a": float("nan")}]], [0], {}),
        ([[["a"]]], [0], {"c2": -1.0}),
        ([[["a"]]], [0], {"sample_weight": [float("inf")]}),
    ],
)
def test_bad_choices_are_refused(choice_sets, chosen, options):
    with pytest.raises(UsageError):
        ChoiceModel.fit(choice_sets, chosen, **options)
    with pytest.raises(UsageError):
        ChoiceModel.from_weights({"a": float("nan")})

"""The estimator: scikit-learn's conventions, unobserved labels, clamping, bad input."""

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import ConvergenceWarning
from sklearn.model_selection import GridSearchCV, cross_val_score
from sklearn.utils import estimator_checks

from explicable.errors import UsageError
from explicable.labelling.crf import ConditionalRandomField


def random_sequences(rng, num_sequences, labels=(False, True), num_features=6):
    """Sequences whose labels depend on features and on the label before."""
    effects = rng.normal(size=(num_features, len(labels)))
    X, y = [], []
    for _ in range(num_sequences):
        sequence, answers, before = [], [], 0
        for _ in range(rng.integers(1, 9)):
            active = np.flatnonzero(rng.random(num_features) < 0.4)
            scores = effects[active].sum(axis=0) + np.where(np.arange(len(labels)) == before, 1.0, 0.0)
            before = int(np.argmax(scores + rng.gumbel(size=len(labels))))
            sequence.append([f"feature {k}" for k in active])
            answers.append(labels[before])
        X.append(sequence)
        y.append(answers)
    return X, y


@pytest.fixture
def data(rng):
    return random_sequences(rng, 40)


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def test_scikit_learn_clones_cross_validates_and_searches(data):
    X, y = data
    crf = ConditionalRandomField(c2=0.1)
    assert clone(crf).get_params() == crf.get_params()
    assert cross_val_score(crf, X, y, cv=4, params={"sample_weight": np.ones(len(X))}).mean() > 0.6
    search = GridSearchCV(crf, {"c2": [0.01, 1.0], "c1": [0.0, 0.5]}, cv=3).fit(X, y)
    assert search.best_estimator_.score(X, y) > 0.6


@pytest.mark.parametrize(
    "check",
    [
        estimator_checks.check_no_attributes_set_in_init,
        estimator_checks.check_parameters_default_constructible,
        estimator_checks.check_get_params_invariance,
        estimator_checks.check_set_params,
        estimator_checks.check_estimator_repr,
        estimator_checks.check_estimator_cloneable,
        estimator_checks.check_estimator_tags_renamed,
        estimator_checks.check_valid_tag_types,
        estimator_checks.check_mixin_order,
    ],
)
def test_what_scikit_learn_checks_without_arrays(check):
    """Its other checks hand in arrays of numbers, and sequences of features are none."""
    check("ConditionalRandomField", ConditionalRandomField())


def test_training_is_deterministic_whatever_the_order_of_features(data, rng):
    X, y = data
    shuffled = [[rng.permutation(position).tolist() for position in sequence] for sequence in X]
    as_mapping = [[dict.fromkeys(position, 1) for position in sequence] for sequence in X]
    weights = ConditionalRandomField().fit(X, y).state_weights_
    for variant in (shuffled, as_mapping, [[frozenset(p) for p in sequence] for sequence in X]):
        again = ConditionalRandomField().fit(iter(variant), iter(y)).state_weights_
        assert np.array_equal(weights, again)


def test_a_sequence_weighted_twice_counts_as_two(data):
    X, y = data
    twice = ConditionalRandomField().fit(X + X[:10], y + y[:10])
    weighted = ConditionalRandomField().fit(X, y, sample_weight=[2.0] * 10 + [1.0] * 30)
    assert twice.state_weights_ == pytest.approx(weighted.state_weights_, abs=1e-5)


def test_at_the_optimum_expected_counts_differ_from_observed_ones_by_the_penalty(data):
    X, y = data
    crf = ConditionalRandomField(c2=0.3).fit(X, y)
    observed, expected = np.zeros(2), np.zeros(2)
    for sequence, answers, table in zip(X, y, crf.predict_marginals(X), strict=True):
        for position, answer, row in zip(sequence, answers, table, strict=True):
            if "feature 2" in position:
                observed[int(answer)] += 1
                expected += row
    weights = crf.state_weights_[crf.feature_names_.index("feature 2")]
    assert observed - expected == pytest.approx(2 * 0.3 * weights, abs=1e-3)


def test_unobserved_positions_are_neither_positive_nor_ignored(data):
    X, y = data
    hidden = [[None if k % 3 == 1 else label for k, label in enumerate(row)] for row in y]
    as_positive = [[True if label is None else label for label in row] for row in hidden]
    full, partial, positive = (ConditionalRandomField().fit(X, labels) for labels in (y, hidden, as_positive))

    def rate(model):
        return np.mean(np.concatenate(model.predict_marginals(X))[:, 1])

    assert abs(rate(partial) - rate(full)) < 0.05
    assert rate(positive) > rate(full) + 0.05


def test_what_is_given_in_training_is_not_explained(data):
    X, y = data
    nothing = [[None] * len(labels) for labels in y]
    alone = ConditionalRandomField(c2=0.1).fit(X, y, given=nothing)
    assert alone.transition_weights_ == pytest.approx(
        ConditionalRandomField(c2=0.1).fit(X, y).transition_weights_, abs=1e-4
    )
    # Sequences of which everything is given teach nothing; as answers they bend the transition weights.
    more = ([*X, *[[[]] * 5] * 20], [*y, *[[True] * 5] * 20])
    given = ConditionalRandomField(c2=0.1).fit(*more, given=[*nothing, *[[True] * 5] * 20])
    assert given.transition_weights_ == pytest.approx(alone.transition_weights_, abs=1e-3)
    answered = ConditionalRandomField(c2=0.1).fit(*more)
    assert answered.transition_weights_[1, 1] > alone.transition_weights_[1, 1] + 0.1
    with pytest.raises(UsageError):
        ConditionalRandomField().fit([[["a"], ["b"]]], [[True, False]], given=[[False, None]])


def test_clamped_positions_have_their_label_and_move_their_neighbours(data):
    X, y = data
    crf = ConditionalRandomField(c2=0.01).fit(X, y)
    sequence = [["feature 1"], [], ["feature 3"]]
    before = []
    for label in (False, True):
        clamp = [[None, label, None]]
        assert crf.predict([sequence], clamp)[0][1] is label
        (table,) = crf.predict_marginals([sequence], clamp)
        assert table[1] == pytest.approx([1.0 - label, float(label)])
        assert table.sum(axis=1) == pytest.approx(1)
        before.append(table[0, 1])
    assert abs(before[0] - before[1]) > 0.01
    (counts,) = crf.predict_counts([sequence], True, clamp=[[None, True, None]], counted=[[1, 1, 0]])
    assert len(counts) == 3
    assert counts[2] == 0


def test_l1_penalty_makes_weights_exactly_zero(data):
    X, y = data
    crf = ConditionalRandomField(c1=3.0, c2=0.0).fit(X, y)
    assert 0 < np.count_nonzero(crf.state_weights_) < crf.state_weights_.size
    assert crf.objective_ == pytest.approx(
        -crf.log_likelihood(X, y)
        + 3.0 * (np.abs(crf.state_weights_).sum() + np.abs(crf.transition_weights_).sum()),
        rel=1e-9,
    )


def test_more_than_two_labels(rng):
    X, y = random_sequences(rng, 60, labels=("goto", "search", "wait"))
    crf = ConditionalRandomField(c2=0.1).fit(X, y)
    assert crf.classes_ == ("goto", "search", "wait")
    assert crf.score(X, y) > 0.5
    reversed_classes = ConditionalRandomField(c2=0.1, classes=("wait", "search", "goto")).fit(X, y)
    assert reversed_classes.state_weights_[:, ::-1] == pytest.approx(crf.state_weights_, abs=1e-3)


def test_empty_sequences_and_unknown_features_have_a_meaning(data):
    X, y = data
    crf = ConditionalRandomField().fit([*X, []], [*y, []])
    assert crf.predict([[], [["never seen"]]])[0] == []
    assert crf.predict([[["never seen"]]]) == crf.predict([[[]]])
    assert crf.predict([]) == []
    assert crf.predict_counts([[]], empty=True)[0].tolist() == [1.0]


def test_one_label_only_is_refused_unless_all_labels_are_named():
    with pytest.raises(UsageError, match="at least two labels"):
        ConditionalRandomField().fit([[["a"]]], [[True]])
    crf = ConditionalRandomField(classes=(True, False)).fit([[["a"]]], [[True]])
    assert crf.predict_marginals([[["a"]]])[0][0, 0] > 0.5


@pytest.mark.parametrize(
    ("X", "y", "message"),
    [
        ([[["a"], ["b"]]], [[True, False, True]], "2 positions but 3 labels"),
        ([[["a"], ["b"]], [["b"]]], [[True, False]], "2 sequences but labels for 1"),
        ([[["a"]]], [[True], [False]], "1 sequences but labels for 2"),
        ([[["a"]]], [[None]], "at least two labels"),
        ([["ab"]], [[True]], "sequence 0, position 0: .*not the string 'ab'"),
        (["ab"], [[True, False]], "sequence 0"),
        ([[["a"], [3]]], [[True, False]], "position 1: a feature's name must be a string"),
        ([[["a"], {"b": float("nan")}]], [[True, False]], "it must be finite"),
        ([[["a"], {"b": -float("inf")}]], [[True, False]], "it must be finite"),
        ([[["a"], {"b": "much"}]], [[True, False]], "no number"),
        ([[["a"], [["b"]]]], [[True, False]], "position 1"),
        ([[["a"], 7]], [[True, False]], "position 1"),
        ([[["a"], ["b"]]], [[True, "maybe"]], "no order"),
    ],
)
def test_bad_sequences_are_refused_with_their_place(X, y, message):
    with pytest.raises(UsageError, match=message):
        ConditionalRandomField().fit(X, y)


@pytest.mark.parametrize(
    "parameters",
    [
        {"c1": -1.0},
        {"c2": float("nan")},
        {"max_iterations": 0},
        {"tolerance": -1.0},
        {"classes": (True, True)},
        {"classes": (True, None)},
        {"classes": (True, "no")},
        {"feature_scale": {"a": float("inf")}},
    ],
)
def test_bad_parameters_are_refused(parameters):
    with pytest.raises(UsageError):
        ConditionalRandomField(**parameters).fit([[["a"], ["b"]]], [[True, False]])


@pytest.mark.parametrize("weight", [[1.0, 1.0], [-1.0], [float("nan")], [float("inf")]])
def test_bad_weights_of_sequences_are_refused(weight):
    with pytest.raises(UsageError):
        ConditionalRandomField().fit([[["a"], ["b"]]], [[True, False]], sample_weight=weight)


def test_misuse_of_a_model_is_refused(data):
    with pytest.raises(UsageError, match="not trained"):
        ConditionalRandomField().predict([[["a"]]])
    with pytest.raises(UsageError, match="no parameter"):
        ConditionalRandomField().set_params(c3=1)
    crf = ConditionalRandomField().fit(*data)
    with pytest.raises(UsageError, match="label 'x' is none of"):
        crf.predict([[["a"]]], clamp=[["x"]])
    with pytest.raises(UsageError, match="label 'x' is none of"):
        crf.log_likelihood([[["a"]]], [["x"]])
    with pytest.raises(UsageError, match="label 'x' is none of"):
        crf.predict_counts([[["a"]]], empty="x")
    with pytest.raises(UsageError, match="one flag for each position"):
        crf.predict_counts([[["a"]]], empty=True, counted=[[1, 1]])
    with pytest.raises(UsageError, match="one label, or None"):
        crf.score([[["a"]]], [[True, False]])
    with pytest.raises(UsageError, match="no labelled position"):
        crf.score([[["a"]]], [[None]])


def test_weights_from_outside_are_checked():
    good = {
        "classes": "ab",
        "feature_names": ["f"],
        "state_weights": [[1, 2]],
        "transition_weights": np.eye(2),
    }
    assert ConditionalRandomField.from_weights(**good).predict([[["f"]]]) == [["b"]]
    for change in (
        {"classes": "a"},
        {"feature_names": ["f", "g"]},
        {"feature_names": ["f", "f"], "state_weights": [[1, 2], [1, 2]]},
        {"state_weights": [[1, np.nan]]},
        {"transition_weights": np.eye(3)},
        {"transition_weights": np.full((2, 2), np.inf)},
    ):
        with pytest.raises(UsageError):
            ConditionalRandomField.from_weights(**good | change)
    with pytest.raises(ValueError, match="too large"):
        ConditionalRandomField.from_weights(**good | {"state_weights": [[1e300, 0]]}).predict([[["f"]]])


def test_stopping_early_is_said(data):
    with pytest.warns(ConvergenceWarning, match="after 2 iterations"):
        assert not ConditionalRandomField(max_iterations=2, c2=0.01).fit(*data).converged_

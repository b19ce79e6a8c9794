"""The conditional random field against CRFsuite: same optimum, same labels."""

import numpy as np
import pytest

from explicable.labelling.crf import ConditionalRandomField
from peers import crfsuite_model

LABELS = ["first", "second", "third"]
FEATURES = [f"feature {k}" for k in range(12)]


def random_sequences(rng, num_sequences, num_labels):
    """The first sequence shows all features and labels in order, so that CRFsuite numbers them as we do."""
    labels = LABELS[:num_labels]
    X, y = [[[name] for name in FEATURES]], [[labels[min(k, num_labels - 1)] for k in range(len(FEATURES))]]
    for _ in range(num_sequences):
        length = rng.integers(1, 12)
        active = rng.random((length, len(FEATURES))) < 0.25
        scores = (
            active[:, :num_labels]
            + 0.7 * active[:, 3 : 3 + num_labels]
            + rng.gumbel(size=(length, num_labels))
        )
        X.append([[FEATURES[k] for k in np.flatnonzero(row)] for row in active])
        y.append([labels[k] for k in scores.argmax(axis=1)])
    return X, y


@pytest.mark.parametrize("num_labels", [2, 3])
@pytest.mark.parametrize(("c1", "c2"), [(0.0, 1.0), (0.0, 0.05), (1.0, 0.1), (2.0, 0.0)])
def test_the_optimum_is_that_of_crfsuite(tmp_path, num_labels, c1, c2):
    X, y = random_sequences(np.random.default_rng(num_labels), 60, num_labels)
    path = tmp_path / "model"
    parameters = {"c1": c1, "c2": c2, "max_iterations": 2000, "epsilon": 1e-9, "delta": 1e-12, "period": 50}
    assert crfsuite_model.train(path, X, y, **parameters) == LABELS[:num_labels]
    state, transition = crfsuite_model.read_weights(path, FEATURES, num_labels)
    theirs = ConditionalRandomField.from_weights(LABELS[:num_labels], FEATURES, state, transition)
    ours = ConditionalRandomField(c1=c1, c2=c2).fit(X, y)

    def objective(model):
        weights = np.concatenate([model.state_weights_.ravel(), model.transition_weights_.ravel()])
        return -model.log_likelihood(X, y) + c1 * np.abs(weights).sum() + c2 * (weights**2).sum()

    assert objective(ours) == pytest.approx(objective(theirs), rel=1e-6)
    assert ours.objective_ == pytest.approx(objective(ours), rel=1e-12)
    if c2 > 0:
        ids = [ours.feature_names_.index(name) for name in FEATURES]
        assert ours.state_weights_[ids] == pytest.approx(state, abs=2e-3)


@pytest.mark.parametrize("num_labels", [2, 3])
def test_labels_are_those_of_crfsuite_ties_included(tmp_path, num_labels):
    """Weights are small integers, so that many labellings have exactly the same score."""
    rng = np.random.default_rng(10 + num_labels)
    X, y = random_sequences(rng, 20, num_labels)
    path = tmp_path / "model"
    crfsuite_model.train(path, X, y, max_iterations=3)
    num_ties = 0
    for _ in range(10):
        state = rng.integers(-1, 2, (len(FEATURES), num_labels)).astype(float)
        transition = rng.integers(-1, 2, (num_labels, num_labels)).astype(float)
        crfsuite_model.write_weights(path, state, transition)
        tagger = crfsuite_model.open_tagger(path)
        classes = LABELS[:num_labels]
        ours = ConditionalRandomField.from_weights(classes, FEATURES, state, transition)
        turned = ConditionalRandomField.from_weights(
            classes[::-1], FEATURES, state[:, ::-1], transition[::-1, ::-1]
        )
        sequences, _ = random_sequences(rng, 150, num_labels)
        predicted = ours.predict(sequences)
        assert predicted == [list(tagger.tag(sequence)) for sequence in sequences]
        num_ties += sum(a != b for a, b in zip(predicted, turned.predict(sequences), strict=True))
    assert num_ties > 200  # whose label order decided

"""The conditional random field against CRFsuite: same optimum, same labels."""

import numpy as np
import pytest

from explicable.execution import builtin_families, simulate_study
from explicable.first_response import builtin_maps, encode
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.learning import TrainingData
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


def objective(model, X, y, c1, c2):
    weights = np.concatenate([model.state_weights_.ravel(), model.transition_weights_.ravel()])
    return -model.log_likelihood(X, y) + c1 * np.abs(weights).sum() + c2 * (weights**2).sum()


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
    assert objective(ours, X, y, c1, c2) == pytest.approx(objective(theirs, X, y, c1, c2), rel=1e-6)
    assert ours.objective_ == pytest.approx(objective(ours, X, y, c1, c2), rel=1e-12)
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
    for _ in range(20):
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


@pytest.fixture(scope="module", params=["lifted", "ground"])
def played(request):
    """What simulated participants said of a robot's steps: features and labels as the labeller sees them."""
    problems = [encode(world) for world in list(builtin_maps("training").values())[:6]]
    data = TrainingData(request.param)
    for episode in simulate_study(problems, builtin_families()["boltzmann"], num_traces=12, way="mixed"):
        data.add(episode.trace)
    X = [[list(row) for row in rows] for rows in data.features]
    return X, [["yes" if label else "no" for label in labels] for labels in data.labels]


@pytest.mark.parametrize(("c1", "c2"), [(0.0, 1.0), (0.5, 0.1), (1.0, 0.0)])
def test_the_optimum_is_that_of_crfsuite_on_traces_too(tmp_path, played, c1, c2):
    X, y = played
    path = tmp_path / "model"
    names = sorted({name for rows in X for row in rows for name in row})
    parameters = {"c1": c1, "c2": c2, "max_iterations": 3000, "epsilon": 1e-9, "delta": 1e-12, "period": 50}
    labels = crfsuite_model.train(path, X, y, **parameters)
    theirs = ConditionalRandomField.from_weights(
        labels, names, *crfsuite_model.read_weights(path, names, len(labels))
    )
    ours = ConditionalRandomField(c1=c1, c2=c2, classes=labels, tolerance=1e-12).fit(X, y)
    least = objective(ours, X, y, c1, c2)
    assert least == pytest.approx(objective(theirs, X, y, c1, c2), rel=1e-6)
    tagger = crfsuite_model.open_tagger(path)
    assert theirs.predict(X) == [list(tagger.tag(sequence)) for sequence in X]

"""Agreement and aggregation of several annotators."""

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.labelling.annotators import aggregate, krippendorff_alpha

RELIABILITY_DATA = """
A * * * * * 3 4 1 2 1 1 3 3 * 3
B 1 * 2 1 3 3 4 3 * * * * * * *
C * * 2 1 3 4 4 * 2 1 1 3 3 * 4
"""


def ratings_of(table):
    rows = [line.split() for line in table.strip().splitlines()]
    items = zip(*(row[1:] for row in rows), strict=True)
    names = [row[0] for row in rows]
    return [{name: label for name, label in zip(names, item, strict=True) if label != "*"} for item in items]


def test_alpha_of_the_published_example():
    """Krippendorff's example with three coders and missing values: alpha = 0.691 for nominal labels."""
    assert krippendorff_alpha(ratings_of(RELIABILITY_DATA)) == pytest.approx(0.691, abs=5e-4)


def test_alpha_of_guesses_is_zero_and_of_copies_one():
    rng = np.random.default_rng(0)
    guesses = [{"ann": bool(a), "bob": bool(b)} for a, b in rng.random((4000, 2)) < 0.7]
    assert krippendorff_alpha(guesses) == pytest.approx(0, abs=0.05)
    assert krippendorff_alpha([{"ann": g["ann"], "bob": g["ann"]} for g in guesses]) == 1.0
    assert krippendorff_alpha([{"ann": True, "bob": True}]) == 1.0


def simulate(rng, num_items, accuracies):
    truth = rng.random(num_items) < 0.7
    ratings = [
        {name: bool(t == (rng.random() < a)) for name, a in accuracies.items() if rng.random() < 0.8}
        for t in truth
    ]
    return truth, ratings


def test_reliable_annotators_are_found_and_outweigh_the_majority():
    accuracies = {
        "expert": 0.97,
        "fair": 0.8,
        "fair too": 0.8,
        "guess 1": 0.5,
        "guess 2": 0.5,
        "guess 3": 0.5,
    }
    truth, ratings = simulate(np.random.default_rng(5), 600, accuracies)
    result = aggregate(ratings)
    said_true = result.probabilities[:, result.classes.index(True)]
    majority = np.array([np.mean(list(item.values())) if item else 0.7 for item in ratings])
    assert np.mean((said_true > 0.5) == truth) > np.mean((majority > 0.5) == truth) + 0.03
    weights = result.weights()
    assert weights["expert"] > 0.8 > weights["fair"] > 0.4 > weights["guess 1"]
    assert result.confusion.sum(axis=2) == pytest.approx(1)
    assert result.prior[result.classes.index(True)] == pytest.approx(0.7, abs=0.06)


def test_disagreement_is_kept_and_items_without_labels_get_the_prior():
    ratings = (
        [{"ann": True, "bob": True}] * 8
        + [{"ann": False, "bob": False}] * 8
        + [{"ann": True, "bob": False}, {}]
    )
    result = aggregate(ratings)
    assert 0.3 < result.probabilities[-2, 1] < 0.7
    assert result.probabilities[-1] == pytest.approx(result.prior, abs=1e-6)
    assert result.probabilities[0, 1] > 0.95


@pytest.mark.parametrize(
    "misuse",
    [
        lambda: krippendorff_alpha([]),
        lambda: krippendorff_alpha([{"ann": True}, {"bob": True}]),
        lambda: krippendorff_alpha([{"ann": True, "bob": None}]),
        lambda: aggregate([]),
        lambda: aggregate([{}]),
        lambda: aggregate([{"ann": True}], smoothing=float("nan")),
    ],
)
def test_misuse_is_refused(misuse):
    with pytest.raises(UsageError):
        misuse()


def test_one_label_only_leaves_nothing_to_estimate():
    result = aggregate([{"ann": True}, {"ann": True}])
    assert result.probabilities.tolist() == [[1.0], [1.0]]
    assert result.weights() == {"ann": 1.0}

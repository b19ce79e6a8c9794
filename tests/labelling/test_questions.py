"""Ranking questions: it prefers what the models disagree about to what is merely uncertain."""

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.questions import label_information, rank_questions
from explicable.labelling.uncertainty import fit_bootstrap


@pytest.fixture(scope="module")
def models():
    """Trained on plans in which `toss-up` is often seen and means nothing, `rare` is seen once."""
    rng = np.random.default_rng(0)
    X = [[["toss-up"], ["clear"], ["toss-up"]] for _ in range(60)] + [[["rare"]]]
    y = [[bool(rng.random() < 0.5), True, bool(rng.random() < 0.5)] for _ in range(60)] + [[False]]
    return fit_bootstrap(ConditionalRandomField(c2=0.05), X, y, rng, 25)


def test_what_models_disagree_about_comes_first(models):
    plans = [[["toss-up"]], [["rare"]], [["clear"]], []]
    ranked = rank_questions(models, plans)
    assert ranked[0].plan == 1
    assert ranked[-1].plan == 3
    assert ranked[0].information > 5 * ranked[1].information
    assert ranked[0].by_step.shape == (1,)


def test_plans_or_single_questions_may_be_what_costs(models):
    plans = [[["rare"], *[["clear"]] * 3, ["rare"]], [["rare"]]]
    assert rank_questions(models, plans)[0].plan == 0
    assert rank_questions(models, plans, per_step=True)[0].plan == 1
    silent = rank_questions(models, plans, may_ask=[[False] * 5, [True]])
    assert silent[0].plan == 1
    assert silent[1].information == 0
    known = rank_questions(models, plans, clamp=[[None] * 5, [False]])
    assert known[-1].information == pytest.approx(0, abs=1e-12)


def test_information_is_bounded_by_the_entropy_of_the_label():
    rng = np.random.default_rng(1)
    probabilities = rng.dirichlet([0.3, 0.3, 0.3], size=(4, 50))
    information = label_information(probabilities)
    assert (information >= 0).all()
    assert (information <= np.log(3)).all()
    assert label_information(probabilities[:1]) == pytest.approx(0, abs=1e-12)


def test_misuse_is_refused(models):
    other = ConditionalRandomField.from_weights("ab", [], [], np.zeros((2, 2)))
    for few in ([], models[:1], [models[0], other]):
        with pytest.raises(UsageError, match="at least two models"):
            rank_questions(few, [[["a"]]])
    with pytest.raises(UsageError, match="one flag for each step"):
        rank_questions(models, [[["a"]]], may_ask=[[True, True]])

"""The compiled scorer agrees with features and chain from scratch, whatever path and relaxed plan."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_teams import problems, walk

from explicable import _core
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.features import TeamFeatures
from explicable.labelling.labeller import CLASSES, Labeller
from explicable.model.grounding import ground_team


@pytest.fixture(scope="module", params=problems())
def team(request):
    return TeamFeatures(ground_team(problems()[request.param]))


def extend_all(scorer, operators, states):
    context = scorer.root(states[0])
    for operator, before, after in zip(operators, states[:-1], states[1:], strict=True):
        context = scorer.extend(context, operator, before, after)
    return context


def random_labeller(team, rng, rounds=20):
    """A labeller with a random weight for every feature that random walks with random tails meet."""
    names = set()
    for _ in range(rounds):
        operators, states = walk(team.task, rng, 12)
        tail = rng.integers(team.task.num_operators, size=6).tolist()
        names.update(*team.extract(operators + tail, states))
    features = sorted(names)
    weights = rng.normal(size=(len(features), 2))
    model = ConditionalRandomField.from_weights(CLASSES, features, weights, rng.normal(size=(2, 2)))
    return Labeller(model, schemas=team.schemas)


def from_scratch(labeller, team, operators, states, *, expected):
    rows = team.extract(operators, states)
    clamp = [[True if team.tables.is_human(operator) else None for operator in operators]]
    if not expected:
        return labeller.model.predict([rows], clamp)[0].count(False), 0.0
    (distribution,) = labeller.model.predict_counts([rows], empty=False, clamp=clamp)
    counts = len(operators) - np.arange(len(operators) + 1)
    mean = distribution @ counts
    return mean, distribution @ (counts - mean) ** 2


@pytest.mark.parametrize("expected", [True, False])
@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_scores_equal_scores_from_scratch(team, expected, seed):
    rng = np.random.default_rng(seed)
    labeller = random_labeller(team, np.random.default_rng(seed % 5))
    scorer = labeller.scorer(team, expected=expected)
    operators, states = walk(team.task, rng, int(rng.integers(25)))
    context = extend_all(scorer, operators, states)
    for _ in range(3):
        tail = rng.integers(team.task.num_operators, size=rng.integers(10)).tolist()
        count, variance, num_steps = scorer.score(context, states[-1], tail)
        assert num_steps == len(operators) + len(tail)
        if num_steps:
            oracle = from_scratch(labeller, team, operators + tail, states, expected=expected)
            assert (count, variance) == pytest.approx(oracle, abs=1e-9)


@pytest.mark.parametrize("expected", [True, False])
def test_equal_closing_keys_score_every_continuation_alike(team, expected):
    rng = np.random.default_rng(7)
    scorer = random_labeller(team, rng).scorer(team, expected=expected)
    groups = {}
    for _ in range(4000):
        operators, states = walk(team.task, rng, int(rng.integers(1, 7)))
        context = extend_all(scorer, operators, states)
        group = groups.setdefault((scorer.closing_key(context), states[-1]), {})
        group[tuple(operators)] = context
    num_merged = 0
    for (_, state), group in groups.items():
        contexts = list(group.values())
        for other in contexts[1:]:
            num_merged += 1
            differences = []
            for _ in range(5):
                tail = rng.integers(team.task.num_operators, size=rng.integers(6)).tolist()
                first, second = (scorer.score(context, state, tail)[0] for context in (contexts[0], other))
                differences.append(second - first)
            assert np.ptp(differences) < 1e-4  # keys are rounded to about a millionth
    assert num_merged > 0


def test_history_is_the_beginning_of_every_path(team):
    rng = np.random.default_rng(3)
    labeller = random_labeller(team, rng)
    operators, states = walk(team.task, rng, 8)
    whole = labeller.scorer(team)
    later = labeller.scorer(team, history=[team.task.action(operator) for operator in operators[:5]])
    context = extend_all(later, operators[5:], states[5:])
    assert later.score(context, states[-1], [0]) == whole.score(
        extend_all(whole, operators, states), states[-1], [0]
    )


def test_numbers_from_outside_never_reach_the_tables(team):
    labeller = random_labeller(team, np.random.default_rng(0))
    scorer = labeller.scorer(team)
    state = team.task.initial_state
    root = scorer.root(state)
    n = team.task.num_operators
    for bad in (b"", b"x", b"\xff" * len(root)):
        with pytest.raises(ValueError, match="context"):
            scorer.score(bad, state, [])
    for bad in (-1, n):
        with pytest.raises(IndexError):
            scorer.extend(root, bad, state, state)
        with pytest.raises(IndexError):
            scorer.score(root, state, [bad])
        with pytest.raises(IndexError):
            team.tables.is_human(bad)
    with pytest.raises(ValueError, match="state"):
        scorer.score(root, b"", [])
    for weights in (
        [(99, (0, 0, 0, 0), 1.0)],
        [(0, (-1, 0, 0, 0), 1.0)],
        [(0, (99, 0, 0, 0), 1.0)],
        [(0, (0, 0, 0, 0), float("nan"))],
    ):
        with pytest.raises(ValueError, match=r"template|range|finite"):
            _core.Scorer(team.task.core, team.tables, weights, [[0, 0], [0, 0]], True)
    with pytest.raises(ValueError, match="transition"):
        _core.Scorer(team.task.core, team.tables, [], [[0, float("inf")], [0, 0]], True)

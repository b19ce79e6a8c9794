"""The compiled scorer agrees with features and chain from scratch, whatever path and relaxed plan."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_teams import problems, random_labeller, walk

from explicable import _core
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team


@pytest.fixture(scope="module", params=problems())
def team(request):
    return TeamFeatures(ground_team(problems()[request.param]))


def extend_all(scorer, operators, states):
    context = scorer.root(states[0])
    for operator, before, after in zip(operators, states[:-1], states[1:], strict=True):
        context = scorer.extend(context, operator, before, after)
    return context


def from_scratch(labeller, team, operators, states, *, expected):
    rows = labeller.familiar_features(team.extract(operators, states))
    clamp = [[True if team.tables.is_human(operator) else None for operator in operators]]
    if not expected:
        return labeller.model.predict([rows], clamp)[0].count(False), 0.0
    (distribution,) = labeller.model.predict_counts([rows], empty=False, clamp=clamp)
    counts = len(operators) - np.arange(len(operators) + 1)
    mean = distribution @ counts
    return mean, distribution @ (counts - mean) ** 2


@pytest.mark.parametrize("expected", [True, False])
@settings(max_examples=60)
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
@pytest.mark.parametrize("scale", [1, 15, 30])
@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_counts_with_a_memory_are_the_counts_without(team, expected, scale, seed):
    # The tails share most pairs of steps, in other states, after other requests and with other goals open.
    # Large weights give odds that can't be multiplied.
    rng = np.random.default_rng(seed)
    labeller = random_labeller(team, np.random.default_rng(seed % 5))
    labeller.model.state_weights_ *= scale
    scorer = labeller.scorer(team, expected=expected)
    steps = rng.integers(team.task.num_operators, size=8)
    for _ in range(6):
        operators, states = walk(team.task, rng, int(rng.integers(12)))
        context = extend_all(scorer, operators, states)
        for _ in range(6):
            tail = rng.choice(steps, size=rng.integers(12)).tolist()
            count = scorer.count(context, states[-1], tail)
            assert count == pytest.approx(scorer.score(context, states[-1], tail)[0], abs=1e-9)
            assert scorer.count(context, states[-1], tail) == count
            if operators:
                parent = extend_all(scorer, operators[:-1], states[:-1])
                child = scorer.count_child(parent, operators[-1], states[-2], states[-1], tail)
                assert child == pytest.approx(count, abs=1e-9)


def alike(team, scorer, key, rng, num_walks=3000):
    """Contexts of random walks that agree in state and key, in groups of several."""
    groups = {}
    for _ in range(num_walks):
        operators, states = walk(team.task, rng, int(rng.integers(1, 9)))
        context = extend_all(scorer, operators, states)
        groups.setdefault((key(context), states[-1]), {})[context] = None
    return [(state, list(group)) for (_, state), group in groups.items() if len(group) > 1]


@pytest.mark.parametrize("expected", [True, False])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_no_continuation_exceeds_the_lead(team, expected, seed):
    rng = np.random.default_rng(seed)
    scorer = random_labeller(team, rng).scorer(team, expected=expected)
    num_bounded = 0
    for state, (a, *others) in alike(team, scorer, scorer.closing_key, rng):
        assert scorer.lead(a, a, state) == 0
        for b in others:
            lead = scorer.lead(a, b, state)
            num_bounded += lead < np.inf
            for _ in range(8):
                tail = rng.integers(team.task.num_operators, size=rng.integers(6)).tolist()
                assert scorer.score(a, state, tail)[0] - scorer.score(b, state, tail)[0] <= lead + 1e-9
    assert num_bounded > 0


@pytest.mark.parametrize("expected", [True, False])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_lower_bounds_add_up_to_no_more_than_the_count(team, expected, seed):
    rng = np.random.default_rng(seed)
    scorer = random_labeller(team, rng).scorer(team, expected=expected)
    bounds = []
    for state, contexts in alike(team, scorer, scorer.outlook_key, rng, num_walks=1500):
        outlook = contexts[0]
        for context in contexts:  # the first stands for all
            outlook = scorer.widen(outlook, context)
        for exact in contexts[:3]:
            seen, ahead = exact, outlook
            bound = scorer.least_count(exact)
            before = state
            for _ in range(int(rng.integers(8))):
                applicable = team.task.applicable(before)
                if not applicable:
                    break
                step = int(rng.choice(applicable))
                after = team.task.successor(before, step)
                wider = scorer.extend(ahead, step, before, after)
                wider = scorer.widen(wider, wider)
                bound += scorer.least_growth(ahead, step, wider)
                seen, ahead, before = scorer.extend(seen, step, before, after), wider, after
                assert scorer.outlook_key(seen) == scorer.outlook_key(ahead)
            bound += scorer.least_end(ahead)
            count = scorer.score(seen, before, [])[0]
            assert bound <= count + 1e-9
            bounds.append((bound, count))
    totals = np.sum(bounds, axis=0)
    assert totals[0] > 0.2 * totals[1]


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

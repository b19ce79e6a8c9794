"""Permutation augmentation, and the orbit theorem of method.md, section 3."""

import itertools
import re
from collections import Counter

import numpy as np
import pytest

from explicable.labelling.augment import augment, ground_symbol_features, permute
from explicable.labelling.crf import ConditionalRandomField
from explicable.pddl.parser import parse_domain, parse_problem

ROOMS = ("a", "b", "c", "d")
GROUP = [dict(zip(ROOMS, image, strict=True)) for image in itertools.permutations(ROOMS)]


def random_traces(rng, num_traces):
    """Walks between rooms; going straight back is mostly called inexplicable."""
    traces = []
    for _ in range(num_traces):
        places = list(rng.choice(ROOMS, 2, replace=False))
        for _ in range(rng.integers(1, 6)):
            places.append(rng.choice([room for room in ROOMS if room != places[-1]]))
        actions = tuple(("go", str(start), str(end)) for start, end in itertools.pairwise(places))
        back = [False] + [after[2] == before[1] for before, after in itertools.pairwise(actions)]
        traces.append((actions, [bool(b) == (rng.random() < 0.2) for b in back]))
    return traces


def features_of(actions):
    """Symbols of the step, and pairs of a symbol with one of the step before."""
    positions = ground_symbol_features(actions)
    pairs = [
        [f"{old} then {new}" for old in before for new in after]
        for before, after in itertools.pairwise(positions)
    ]
    return [own + joint for own, joint in zip(positions, [[], *pairs], strict=True)]


def image(feature, permutation):
    """The feature under a renaming of rooms."""
    return re.sub(r"\b[abcd]\b", lambda match: permutation[match[0]], feature)


@pytest.mark.parametrize("c1", [0.0, 0.02])
def test_base_traces_with_scaled_penalties_give_the_weights_of_full_augmentation(c1):
    traces = random_traces(np.random.default_rng(3), 12)
    X = [features_of(permute(actions, g)) for actions, _ in traces for g in GROUP]
    y = [labels for _, labels in traces for _ in GROUP]
    full = ConditionalRandomField(c1=c1, c2=0.7, tolerance=1e-15).fit(X, y)

    def orbit(feature):
        return frozenset(image(feature, g) for g in GROUP)

    name = {}  # of an orbit: the least of its features
    for feature in full.feature_names_:
        name[feature] = min(orbit(feature))
    lifted = [
        [Counter(name[f] for f in position) for position in features_of(actions)] for actions, _ in traces
    ]
    small = ConditionalRandomField(
        c1=c1,
        c2=0.7,
        tolerance=1e-15,
        feature_scale={representative: len(orbit(feature)) for feature, representative in name.items()},
    ).fit(lifted, [labels for _, labels in traces], sample_weight=np.full(len(traces), len(GROUP)))

    assert len(full.feature_names_) > 8 * len(small.feature_names_)
    assert small.objective_ == pytest.approx(full.objective_, rel=1e-10)
    assert small.transition_weights_ == pytest.approx(full.transition_weights_, abs=1e-5)
    weights = dict(zip(small.feature_names_, small.state_weights_, strict=True))
    expected = np.array([weights[name[feature]] for feature in full.feature_names_])
    assert full.state_weights_ == pytest.approx(expected, abs=1e-5)


DOMAIN = parse_domain(
    "(define (domain d) (:requirements :typing) (:types room robot) (:constants hall - room))"
)
PROBLEM = """(define (problem p) (:domain d) (:objects a b c - room r1 r2 - robot) (:init) (:goal (and)))"""


def test_augmentation_is_seeded_keeps_types_and_shares_permutations_within_a_problem():
    problem, other = parse_problem(PROBLEM, DOMAIN), parse_problem(PROBLEM, DOMAIN)
    actions = (("go", "r1", "a", "hall"), ("go", "r2", "b", "a"))
    traces = [(problem, actions, "x"), (problem, actions[::-1], "y"), (other, actions, "z")]
    first, again = (list(augment(np.random.default_rng(5), traces, 50)) for _ in range(2))
    assert first == again
    assert [label for _, label in first] == ["x"] * 51 + ["y"] * 51 + ["z"] * 51
    assert first[0] == (actions, "x")
    assert all(one[::-1] == two for (one, _), (two, _) in zip(first[:51], first[51:102], strict=True))
    assert [copy for copy, _ in first[:51]] != [copy for copy, _ in first[102:]]
    for (first_step, second_step), _ in first[:51]:
        assert first_step[0] == "go"
        assert {first_step[1], second_step[1]} == {"r1", "r2"}
        assert first_step[2] == second_step[3]
        assert first_step[3] == "hall"
        assert {first_step[2], second_step[2]} < {"a", "b", "c"}
    assert len({copy for copy, _ in first[:51]}) == 12

"""The best J that anytime search proves, against enumeration of all plans of tiny team tasks."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_teams import random_labeller

from explicable.first_response.encoding import encode
from explicable.first_response.map_file import parse_map
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.search import search

MAPS = ("@*\n", "@.*\n", "*@*\n", "@*\n.o\n", "@x\n.*\n", "@*\n*x\n")


@pytest.fixture(scope="module", params=[(m, s) for m in MAPS for s in ("persistent", "exclusive")], ids=str)
def team(request):
    text, semantics = request.param
    return TeamFeatures(ground_team(encode(parse_map(text), semantics)))


def least_objective(task, scorer, alpha):
    """J of the best plan: all plans are looked at whose cost alone does not exceed the best so far."""
    best = float("inf")
    pending = [(task.initial_state, scorer.root(task.initial_state), 0)]
    while pending:  # breadth first, so that short plans come early
        longer = []
        for state, context, cost in pending:
            if task.is_goal(state):
                best = min(best, cost + alpha * scorer.score(context, state, [])[0])
            for step in task.applicable(state):
                after = task.successor(state, step)
                longer.append((after, scorer.extend(context, step, state, after), cost + task.cost(step)))
        pending = [node for node in longer if node[2] < best]
        if len(pending) > 100_000:
            return None
    return best


@pytest.mark.parametrize("expected", [True, False])
@settings(max_examples=6)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.3, 1.0]))
def test_the_proved_objective_is_the_least(team, expected, seed, alpha):
    labeller = random_labeller(team, np.random.default_rng(seed))
    scorer = labeller.scorer(team, expected=expected)
    best = least_objective(team.task, scorer, alpha)
    result = search(team.task, "anytime", scorer=scorer, alpha=alpha)
    assert result.is_optimal
    assert result.lower_bound <= result.objective
    if best is not None:
        assert result.objective == pytest.approx(best)
    limited = search(team.task, "anytime", scorer=scorer, alpha=alpha, max_evaluations=20)
    if limited.objective is not None:
        assert limited.lower_bound <= result.objective + 1e-9
        assert limited.objective >= result.objective - 1e-9

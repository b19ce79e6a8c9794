"""Anytime improvement on maps that are too large to prove anything."""

import numpy as np
import pytest

from explicable.first_response import encode, generate
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.search import search
from planning.floors import judge_of_progress


@pytest.fixture(scope="module")
def large():
    world = generate(np.random.default_rng(1), height=14, width=14, num_marks=6)
    team = TeamFeatures(ground_team(encode(world)))
    return team.task, judge_of_progress(strength=1.0).scorer(team)


def improve(large, max_evaluations, **options):
    task, scorer = large
    found = []
    result = search(
        task,
        "anytime",
        scorer=scorer,
        alpha=1.0,
        max_evaluations=max_evaluations,
        on_better=found.append,
        **options,
    )
    return result, found


def test_more_time_never_makes_a_plan_worse_and_soon_better(large):
    first, _ = improve(large, 1_500)
    later, found = improve(large, 60_000)
    assert later.objective < 0.99 * first.objective
    assert later.lower_bound <= later.objective
    assert found == sorted(found, reverse=True)
    assert found[-1] == later.objective


def test_the_same_seed_gives_the_same_plan(large):
    one, other = (improve(large, 10_000, seed=3)[0] for _ in range(2))
    assert (one.operators, one.objective) == (other.operators, other.objective)


def test_the_objective_is_that_of_the_plan(large):
    task, scorer = large
    result, _ = improve(large, 10_000)
    state = task.initial_state
    context = scorer.root(state)
    for operator in result.operators:
        after = task.successor(state, operator)
        context = scorer.extend(context, operator, state, after)
        state = after
    assert task.is_goal(state)
    assert result.objective == pytest.approx(result.cost + scorer.score(context, state, [])[0])


def test_what_on_better_raises_ends_the_search(large):
    task, scorer = large

    def refuse(objective):  # noqa: ARG001 (the callback's signature)
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        search(task, "anytime", scorer=scorer, alpha=1.0, on_better=refuse, max_evaluations=5000)

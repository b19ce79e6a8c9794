"""Labelled search against Eq. 4 by the book, and the best J against enumeration."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tiny_strategies import tiny_tasks

from explicable import _core
from explicable.errors import UsageError
from explicable.model.grounding import ground
from explicable.search import Outcome, search
from oracles.explicable_search import best_first, climb, least_objective, weighing
from oracles.tiny_tasks import TinyEffect, TinyOperator, TinyTask


def grounded(tiny, data):
    task = ground(tiny.problem())
    weight = st.sampled_from([0.0, 0.0, 0.25, 1.0])
    return task, data.draw(st.lists(weight, min_size=task.num_operators, max_size=task.num_operators))


@given(tiny_tasks(max_facts=7), st.data())
def test_hill_climbing_and_best_first_search_follow_equation_4(tiny, data):
    task, weights = grounded(tiny, data)
    if not task.goal_reachable:
        return
    scorer = _core.CountingScorer(weights)
    by_the_book = best_first(task, weighing(weights))
    assert search(task, "eager", scorer=scorer).operators == by_the_book
    climbed = climb(task, weighing(weights))
    assert search(task, "ff", scorer=scorer).operators == (by_the_book if climbed is None else climbed)


@given(tiny_tasks(), st.data())
def test_weights_of_zero_leave_hill_climbing_as_it_was(tiny, data):
    task, weights = grounded(tiny, data)
    nothing = _core.CountingScorer([0.0] * len(weights))
    assert search(task, "ff", scorer=nothing).outcome is search(task, "ff").outcome
    if climb(task, weighing([0.0] * len(weights))) is not None:
        assert search(task, "ff", scorer=nothing).operators == search(task, "ff").operators


@given(tiny_tasks(), st.data(), st.sampled_from(["default", "lazy", "eager", "ff"]))
def test_context_closing_loses_no_plan(tiny, data, algorithm):
    task, weights = grounded(tiny, data)
    plain = search(task, algorithm)
    labelled = search(task, algorithm, scorer=_core.CountingScorer(weights), closing="context")
    assert labelled.outcome is plain.outcome


@settings(max_examples=50)
@given(tiny_tasks(min_cost=1, max_facts=4, max_operators=4), st.data(), st.sampled_from([0.0, 0.5, 2.0]))
@pytest.mark.parametrize("distance", ["count", "ratio"])
def test_anytime_search_finds_the_least_objective(distance, tiny, data, alpha):
    task, weights = grounded(tiny, data)

    def penalty(path):
        inexplicable = sum(weights[step] for step in path)
        return alpha * (inexplicable if distance == "count" else inexplicable / max(len(path), 1))

    scorer = _core.CountingScorer(weights)
    result = search(task, "anytime", scorer=scorer, alpha=alpha, distance=distance)
    best = least_objective(task, penalty, max_steps=5)
    if result.outcome is Outcome.UNSOLVABLE:
        assert best == float("inf")
    else:
        assert result.is_optimal
        assert result.objective == pytest.approx(result.cost + penalty(result.operators))
        assert result.lower_bound == result.objective
        assert result.objective <= best + 1e-9


class Counting:
    """What CountingScorer does, in Python."""

    def __init__(self, weights):
        self.weights = weights

    def root(self, state):
        assert isinstance(state, bytes)
        return ()

    def extend(self, context, step, before, after):
        assert isinstance(before, bytes)
        assert len(before) == len(after)
        return (*context, step)

    def score(self, context, state, relaxed_plan):  # noqa: ARG002 (the scorer's signature)
        steps = (*context, *relaxed_plan)
        return sum(self.weights[step] for step in steps), 0.0, len(steps)

    def closing_key(self, context):  # noqa: ARG002 (the scorer's signature)
        return 0


@settings(max_examples=50)
@given(
    tiny_tasks(), st.data(), st.sampled_from(["ff", "lazy", "eager"]), st.sampled_from(["state", "context"])
)
def test_a_python_scorer_is_as_good_as_a_compiled_one(tiny, data, algorithm, closing):
    task, weights = grounded(tiny, data)
    compiled = search(task, algorithm, scorer=_core.CountingScorer(weights), closing=closing)
    asked = _core.CallbackScorer(task.core, Counting(weights))
    assert search(task, algorithm, scorer=asked, closing=closing).operators == compiled.operators


@settings(max_examples=50)
@given(tiny_tasks(min_cost=1), st.data(), st.sampled_from(["count", "ratio"]))
def test_a_scorer_without_bounds_proves_the_same_objective(tiny, data, distance):
    task, weights = grounded(tiny, data)
    compiled = search(task, "anytime", scorer=_core.CountingScorer(weights), alpha=0.5, distance=distance)
    asked = _core.CallbackScorer(task.core, Counting(weights))
    result = search(task, "anytime", scorer=asked, alpha=0.5, distance=distance)
    assert (result.objective, result.is_optimal) == (
        None if compiled.objective is None else pytest.approx(compiled.objective),
        compiled.is_optimal,
    )


def test_a_gap_is_enough_of_a_proof():
    # Two ways: one step that is inexplicable at 0.9, and two steps that are explicable.
    steps = (
        TinyOperator(frozenset([0]), (TinyEffect(frozenset(), frozenset([2]), frozenset()),), 1),
        TinyOperator(frozenset([0]), (TinyEffect(frozenset(), frozenset([1]), frozenset()),), 1),
        TinyOperator(frozenset([1]), (TinyEffect(frozenset(), frozenset([2]), frozenset()),), 1),
    )
    task = ground(TinyTask(3, steps, frozenset([0]), frozenset([2])).problem())
    weights = [0.9 if task.action(operator) == ("a0",) else 0.0 for operator in range(task.num_operators)]
    scorer = _core.CountingScorer(weights)
    exact = search(task, "anytime", scorer=scorer, alpha=2.0)
    assert (exact.objective, exact.lower_bound, exact.is_optimal) == (2.0, 2.0, True)
    rough = search(task, "anytime", scorer=scorer, alpha=2.0, gap=0.5)
    assert rough.lower_bound <= 2.0 <= rough.objective
    assert rough.lower_bound >= 0.5 * rough.objective
    with pytest.raises(UsageError, match="gap"):
        search(task, "anytime", gap=1.0)


def test_errors_of_a_python_scorer_come_through():
    task = ground(TinyTask(1, (), frozenset(), frozenset()).problem())

    class Broken(Counting):
        def root(self, state):  # noqa: ARG002 (the scorer's signature)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        search(task, "lazy", scorer=_core.CallbackScorer(task.core, Broken([])))


@settings(max_examples=50)
@given(tiny_tasks(), st.data())
def test_zero_costs_do_not_keep_a_ratio_from_ending(tiny, data):
    task, weights = grounded(tiny, data)
    result = search(task, "anytime", scorer=_core.CountingScorer(weights), alpha=1.0, distance="ratio")
    assert result.outcome is search(task).outcome


def test_a_scorer_is_refused_where_it_means_nothing():
    task = ground(TinyTask(1, (), frozenset([0]), frozenset([0])).problem())
    with pytest.raises(UsageError, match="labelled"):
        search(task, "astar", scorer=_core.CountingScorer([]))
    with pytest.raises(UsageError, match="another task"):
        search(task, scorer=_core.CountingScorer([0.0]))

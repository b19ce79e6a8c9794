"""Look-ahead changes where search looks first, not what is true; improved plans cost no more."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tiny_strategies import tiny_tasks

from explicable import _core
from explicable.first_response import encode, generate
from explicable.model.grounding import ground, ground_team
from explicable.pddl import parse_domain, parse_problem
from explicable.search import search
from oracles.tiny_tasks import TinyEffect, TinyOperator, TinyTask

FERRY = """
(define (domain ferry) (:requirements :typing) (:types bank car)
  (:predicates (at ?c - car ?b - bank) (ferry-at ?b - bank) (aboard ?c - car) (empty))
  (:action sail :parameters (?from ?to - bank) :precondition (ferry-at ?from)
    :effect (and (ferry-at ?to) (not (ferry-at ?from))))
  (:action board :parameters (?c - car ?b - bank) :precondition (and (at ?c ?b) (ferry-at ?b) (empty))
    :effect (and (aboard ?c) (not (at ?c ?b)) (not (empty))))
  (:action debark :parameters (?c - car ?b - bank) :precondition (and (aboard ?c) (ferry-at ?b))
    :effect (and (at ?c ?b) (empty) (not (aboard ?c)))))
"""
CLOSINGS = st.sampled_from(["state", "context"])


def execute(task, operators):
    state = task.initial_state
    for operator in operators:
        assert task.is_applicable(state, operator)
        state = task.successor(state, operator)
    return state


def cost(task, operators):
    return sum(task.cost(operator) for operator in operators)


@given(tiny_tasks(), st.integers(0, 2))
def test_lookahead_changes_nothing_about_solvability(tiny, seed):
    task = ground(tiny.problem())
    plain, ahead = (search(task, "lazy", lookahead=lookahead, seed=seed) for lookahead in (False, True))
    assert ahead.outcome is plain.outcome
    if ahead.operators is not None:
        assert task.is_goal(execute(task, ahead.operators))
        assert ahead.cost == cost(task, ahead.operators)


@given(tiny_tasks(max_facts=7), st.data(), CLOSINGS)
def test_labelled_contexts_follow_the_steps_of_a_lookahead(tiny, data, closing):
    task = ground(tiny.problem())
    weights = data.draw(
        st.lists(st.sampled_from([0.0, 0.25, 1.0]), min_size=task.num_operators, max_size=task.num_operators)
    )

    class Replaying:
        """Keeps the whole path, and executes it anew whenever it is asked for a score."""

        def root(self, state):
            assert state == task.initial_state
            return ()

        def extend(self, context, step, before, after):
            assert before == execute(task, context)
            assert after == task.successor(before, step)
            return (*context, step)

        def score(self, context, state, relaxed_plan):
            assert state == execute(task, context)
            steps = (*context, *relaxed_plan)
            return sum(weights[step] for step in steps), 0.0, len(steps)

        def closing_key(self, context):  # noqa: ARG002 (the scorer's signature)
            return 0

    replaying = _core.CallbackScorer(task.core, Replaying())
    compiled = _core.CountingScorer(weights)
    options = {"algorithm": "lazy", "closing": closing, "lookahead": True}
    result = search(task, scorer=replaying, **options)
    assert result.operators == search(task, scorer=compiled, **options).operators
    assert result.outcome is search(task).outcome


def test_contexts_of_a_lookahead_that_ends_short_of_the_goal():
    # Nobody asks about the steps on the way, so their contexts are made at the end.
    class Following:
        def root(self, state):
            return state

        def extend(self, context, step, before, after):
            assert before == context
            assert after == task.successor(before, step)
            return after

        def score(self, context, state, relaxed_plan):
            assert context == state
            return 0.0, 0.0, len(relaxed_plan)

    task = ground_team(encode(generate(np.random.default_rng(1)))).task
    following = _core.CallbackScorer(task.core, Following())
    assert search(task, "lazy", scorer=following, closing="state", lookahead=True).evaluations > 1


def test_a_lookahead_goes_back_for_what_it_has_lost():
    cars = [f"car{number}" for number in range(30)]
    problem = f"""(define (problem crossing) (:domain ferry)
        (:objects left right - bank {" ".join(cars)} - car)
        (:init (ferry-at left) (empty) {" ".join(f"(at {car} left)" for car in cars)})
        (:goal (and {" ".join(f"(at {car} right)" for car in cars)})))"""
    task = ground(parse_problem(problem, parse_domain(FERRY)))
    result = search(task, "lazy", lookahead=True)
    assert result.evaluations == 1  # the relaxed plan sails once
    assert result.cost == 4 * len(cars) - 1


@st.composite
def wandering_plans(draw):
    """A task whose goal is something that holds at the end of a random walk, and the walk."""
    task = ground(draw(tiny_tasks()).problem())
    state, plan = task.initial_state, []
    for _ in range(draw(st.integers(0, 12))):
        applicable = task.applicable(state)
        if not applicable:
            break
        plan.append(draw(st.sampled_from(applicable)))
        state = task.successor(state, plan[-1])
    true = sorted(task.atoms(state))
    wanted = draw(st.lists(st.sampled_from(true), max_size=2)) if true else []
    return task.with_goal(wanted), plan


@given(wandering_plans())
def test_no_step_can_be_dropped_after_elimination(wandering):
    task, plan = wandering
    shorter = _core.eliminate_actions(task.core, None, list(task.goal), plan)
    assert task.is_goal(execute(task, shorter))
    assert cost(task, shorter) <= cost(task, plan)
    for dropped in range(len(shorter)):
        rest = shorter[:dropped] + shorter[dropped + 1 :]
        with pytest.raises(AssertionError):
            assert task.is_goal(execute(task, rest))


@given(wandering_plans(), st.sampled_from([0, 5, 100_000]))
def test_the_neighbourhood_holds_no_dearer_plan(wandering, max_transitions):
    task, plan = wandering
    cheaper = _core.search_neighbourhood(task.core, None, list(task.goal), plan, max_transitions)
    assert task.is_goal(execute(task, cheaper))
    assert cost(task, cheaper) <= cost(task, plan)
    if max_transitions == 100_000:  # more than these tasks have
        assert cost(task, cheaper) == search(task, "astar").cost


def test_what_is_no_plan_cannot_be_improved():
    add = TinyOperator(frozenset(), (TinyEffect(frozenset(), frozenset([0]), frozenset()),), 1)
    task = ground(TinyTask(1, (add,), frozenset(), frozenset([0])).problem())
    for plan in ([5], [-1], []):
        with pytest.raises((ValueError, IndexError)):
            _core.eliminate_actions(task.core, None, list(task.goal), plan)

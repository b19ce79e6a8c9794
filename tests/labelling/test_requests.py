"""Requests by their one definition: what the model says and what the compiled tables say are the same."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_teams import problems

from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.model.requests import find_requests
from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem
from oracles import random_problems

AGENTS = {"human": ("object",), "robot": ("object",), "place": ("human",), "box": ("thing", "robot")}


def random_team(rng):
    """A random problem in which places are people and boxes are robots."""
    problem = random_problems.ProblemMaker(rng, strips=rng.random() < 0.5).problem()
    domain = replace(problem.domain, types={**problem.domain.types, **AGENTS})
    return TeamProblem(replace(problem, domain=domain))


def compare(problem):
    """Hold the two against each other; returns the requests."""
    team = TeamFeatures(ground_team(problem))
    task, tables = team.task, team.tables
    requests = find_requests(problem, task)
    operators = [o for o in range(task.num_operators) if task.action(o)]
    assert [tables.is_human(o) for o in operators] == [
        problem.agent_of(task.action(o)).kind == "human" for o in operators
    ]
    asking = {task.action(o): tables.asks_for(o) for o in operators if tables.asks_for(o) >= 0}
    assert asking.keys() == requests.keys()
    for action, number in asking.items():
        assert {task.fact(fact) for fact in tables.request_facts[number]} == requests[action].permits
        fulfilling = {task.action(o) for o in range(task.num_operators) if number in tables.fulfils(o)}
        assert fulfilling == requests[action].fulfilled_by
    return requests


@settings(max_examples=200)
@given(st.randoms(use_true_random=True))
def test_the_two_agree_on_random_problems(rng):
    compare(random_team(rng))


@pytest.mark.parametrize("name", problems())
def test_the_two_agree_on_teams(name):
    assert compare(problems()[name])


DOMAIN = """
(define (domain shelf) (:requirements :typing :negative-preconditions :conditional-effects)
  (:types robot human item)
  (:predicates (asked ?i - item) (urgent ?i - item) (alarm) (locked ?i - item) (got ?i - item)
    (tired ?h - human))
  (:action ask :parameters (?h - human ?i - item)
    :effect (and (asked ?i) (urgent ?i) (alarm) (not (locked ?i)) (tired ?h)))
  (:action remind :parameters (?h - human ?i - item) :effect (and (asked ?i) (urgent ?i)))
  (:action hint :parameters (?h - human ?i - item) :effect (when (tired ?h) (asked ?i)))
  (:action fetch :parameters (?r - robot ?i - item)
    :precondition (and (asked ?i) (alarm) (not (locked ?i))) :effect (got ?i))
  (:action hurry :parameters (?r - robot ?i - item) :precondition (urgent ?i) :effect (got ?i))
  (:action help :parameters (?r - robot ?h - human) :precondition (tired ?h) :effect (not (tired ?h))))
"""
PROBLEM = """(define (problem p) (:domain shelf)
  (:objects r - robot ann bob - human x y - item) (:init (locked x)) (:goal (and (got x) (got y))))"""


def test_what_a_step_asks_by_and_who_fulfils_it():
    requests = compare(TeamProblem(parse_problem(PROBLEM, parse_domain(DOMAIN))))
    assert requests.keys() == {(a, h, i) for a in ("ask", "remind") for h in ("ann", "bob") for i in "xy"}
    one = requests["ask", "ann", "x"]
    assert one.permits == {("asked", "x"), ("urgent", "x")}  # no alarm, no unlocking, not who is tired
    assert one.fulfilled_by == {("fetch", "r", "x"), ("hurry", "r", "x")}
    assert requests["remind", "bob", "x"].permits == one.permits  # another schema, another person

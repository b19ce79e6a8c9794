"""The reachable operators against those of tarski's grounder, which is a logic program for clingo."""

import warnings

import pytest

from explicable.first_response import builtin_maps, encode
from explicable.model.grounding import ground
from explicable.model.problem import Problem
from explicable.pddl import format_domain, format_problem, parse_domain, parse_problem

FERRY = """
(define (domain ferry) (:requirements :strips :typing)
  (:types car place)
  (:predicates (at-ferry ?p - place) (at ?c - car ?p - place) (on ?c - car) (empty) (way ?p ?q - place))
  (:action sail :parameters (?p ?q - place)
    :precondition (and (at-ferry ?p) (way ?p ?q)) :effect (and (at-ferry ?q) (not (at-ferry ?p))))
  (:action board :parameters (?c - car ?p - place)
    :precondition (and (at-ferry ?p) (at ?c ?p) (empty))
    :effect (and (on ?c) (not (at ?c ?p)) (not (empty))))
  (:action debark :parameters (?c - car ?p - place)
    :precondition (and (at-ferry ?p) (on ?c)) :effect (and (at ?c ?p) (empty) (not (on ?c)))))
"""
FERRY_PROBLEM = """
(define (problem p) (:domain ferry) (:objects a b - car l m n o - place)
  (:init (at-ferry l) (at a m) (at b o) (empty) (way l m) (way m l) (way m n) (way o l))
  (:goal (at a n)))
"""


def peers_operators(folder, problem: Problem):
    """Schemas with the arguments that the program reaches."""
    from tarski.grounding import LPGroundingStrategy
    from tarski.io import PDDLReader

    (folder / "domain.pddl").write_text(format_domain(problem.domain))
    (folder / "problem.pddl").write_text(format_problem(problem))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its own, about how it calls clingo
        reader = PDDLReader(raise_on_error=True)
        reader.parse_domain(str(folder / "domain.pddl"))
        task = reader.parse_instance(str(folder / "problem.pddl"))
        reached = LPGroundingStrategy(task).ground_actions()
    return {(schema, *arguments) for schema, bindings in reached.items() for arguments in bindings}


PROBLEMS = {
    "ferry": lambda: parse_problem(FERRY_PROBLEM, parse_domain(FERRY)),
    "map": lambda: encode(builtin_maps("test")["test-01"]).composite,
    "map as believed": lambda: encode(builtin_maps("test")["test-02"]).mental,
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_same_operators(name, tmp_path):
    problem = PROBLEMS[name]()
    task = ground(problem)
    own = {task.action(operator) for operator in range(task.num_operators)}
    assert own == peers_operators(tmp_path, problem)
    assert len(own) > 8

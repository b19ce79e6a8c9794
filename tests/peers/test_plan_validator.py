"""Plans, judged by a validator that was not written here."""

import warnings
from pathlib import Path

import pytest
from unified_planning.engines import SequentialPlanValidator, ValidationResultStatus
from unified_planning.io import PDDLReader

from explicable.first_response import builtin_maps, encode
from explicable.model.grounding import ground
from explicable.model.plan import format_plan
from explicable.pddl import format_domain, format_problem, parse_domain, parse_problem, read_pair
from explicable.search import search

SURVEY = Path(__file__).parents[2] / "examples" / "rover-survey"
# Conditional effects, quantifiers, disjunctions, negation and costs, all in one.
HARBOUR = """
(define (domain harbour) (:requirements :adl :typing :action-costs) (:types crate place)
  (:predicates (at ?c - crate ?p - place) (held ?c - crate) (shut ?p - place) (wet ?c - crate))
  (:functions (total-cost) - number)
  (:action lift :parameters (?c - crate ?p - place)
    :precondition (and (at ?c ?p) (not (shut ?p)) (not (exists (?d - crate) (held ?d))))
    :effect (and (held ?c) (not (at ?c ?p)) (increase (total-cost) 2)))
  (:action drop :parameters (?c - crate ?p - place)
    :precondition (and (held ?c) (or (not (shut ?p)) (wet ?c)))
    :effect (and (not (held ?c)) (at ?c ?p) (increase (total-cost) 1)))
  (:action flood :parameters (?p - place)
    :effect (and (shut ?p) (forall (?c - crate) (when (at ?c ?p) (wet ?c))) (increase (total-cost) 5)))
  (:action close :parameters (?p - place)
    :effect (and (shut ?p) (increase (total-cost) 9))))
"""
CRATES = """
(define (problem crates) (:domain harbour) (:objects c1 c2 c3 - crate p1 p2 p3 - place)
  (:init (at c1 p1) (at c2 p1) (at c3 p3) (shut p3) (= (total-cost) 0))
  (:goal (and (forall (?c - crate) (exists (?p - place) (and (at ?c ?p) (shut ?p)))) (wet c1) (not (wet c2))))
  (:metric minimize (total-cost)))
"""
PROBLEMS = {
    "harbour": lambda: parse_problem(CRATES, parse_domain(HARBOUR)),
    "map": lambda: encode(builtin_maps("test")["test-01"]).composite,
    "rovers": lambda: read_pair(SURVEY / "domain.pddl", SURVEY / "problem.pddl"),
}


@pytest.mark.parametrize("algorithm", ["default", "ff", "lazy", "eager", "bfws", "wastar"])
@pytest.mark.parametrize("name", PROBLEMS)
def test_plans_are_valid(name, algorithm, tmp_path):
    problem = PROBLEMS[name]()
    task = ground(problem)
    result = search(task, algorithm)
    files = [tmp_path / "domain.pddl", tmp_path / "problem.pddl", tmp_path / "plan"]
    actions = [task.action(operator) for operator in result.operators]
    texts = (format_domain(problem.domain), format_problem(problem), format_plan(actions, result.cost))
    for file, text in zip(files, texts, strict=True):
        file.write_text(text)
    reader = PDDLReader()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # its own, of its parser
        peers_problem = reader.parse_problem(str(files[0]), str(files[1]))
        plan = reader.parse_plan(peers_problem, str(files[2]))
    with SequentialPlanValidator() as validator:
        assert validator.validate(peers_problem, plan).status == ValidationResultStatus.VALID

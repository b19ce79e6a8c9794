"""The reachable operators against those of Fast Downward's translator."""

import contextlib
import io
import warnings

import pytest
from fast_downward.translate import instantiate, normalize, options
from fast_downward.translate import pddl_parser as peer_parser
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from explicable.model.grounding import ground
from explicable.pddl import format_domain, format_problem, parse_domain, parse_problem
from oracles.random_problems import ProblemMaker

LOGISTICS = """
(define (domain logistics) (:requirements :strips :typing)
  (:types truck airplane - vehicle package vehicle - physobj airport location - place
   city place physobj - object)
  (:predicates (in-city ?loc - place ?city - city) (at ?obj - physobj ?loc - place)
               (in ?pkg - package ?veh - vehicle))
  (:action load :parameters (?pkg - package ?veh - vehicle ?loc - place)
    :precondition (and (at ?veh ?loc) (at ?pkg ?loc)) :effect (and (not (at ?pkg ?loc)) (in ?pkg ?veh)))
  (:action unload :parameters (?pkg - package ?veh - vehicle ?loc - place)
    :precondition (and (at ?veh ?loc) (in ?pkg ?veh)) :effect (and (not (in ?pkg ?veh)) (at ?pkg ?loc)))
  (:action drive :parameters (?truck - truck ?from ?to - place ?city - city)
    :precondition (and (at ?truck ?from) (in-city ?from ?city) (in-city ?to ?city))
    :effect (and (not (at ?truck ?from)) (at ?truck ?to)))
  (:action fly :parameters (?plane - airplane ?from ?to - airport)
    :precondition (at ?plane ?from) :effect (and (not (at ?plane ?from)) (at ?plane ?to))))
"""
LOGISTICS_PROBLEM = """
(define (problem p) (:domain logistics)
  (:objects c1 c2 c3 - city a1 a2 a3 - airport l1 l2 l3 - location
   t1 t2 - truck p1 - airplane k1 k2 k3 - package)
  (:init (in-city a1 c1) (in-city l1 c1) (in-city a2 c2) (in-city l2 c2) (in-city a3 c3) (in-city l3 c3)
         (at t1 l1) (at t2 a2) (at p1 a1) (at k1 l1) (at k2 l3) (at k3 a2))
  (:goal (and (at k1 l2) (at k2 a3) (at k3 l1))))
"""
DOCKS = """
(define (domain docks) (:requirements :adl)
  (:types crate place)
  (:predicates (at ?c - crate ?p - place) (held ?c - crate) (shut ?p - place)
   (next ?p ?q - place) (wet ?c - crate))
  (:action lift :parameters (?c - crate ?p - place)
    :precondition (and (at ?c ?p) (not (shut ?p)) (not (exists (?d - crate) (held ?d))))
    :effect (and (held ?c) (not (at ?c ?p))))
  (:action drop :parameters (?c - crate ?p - place)
    :precondition (and (held ?c)
     (or (not (shut ?p)) (exists (?q - place) (and (next ?p ?q) (not (shut ?q))))))
    :effect (and (not (held ?c)) (at ?c ?p)))
  (:action storm :parameters (?p - place)
    :effect (and (shut ?p) (forall (?c - crate) (when (at ?c ?p) (wet ?c)))))
  (:action open :parameters (?p - place) :effect (not (shut ?p)))
  (:action dry :parameters (?c - crate) :precondition (wet ?c) :effect (not (wet ?c))))
"""
DOCKS_PROBLEM = """
(define (problem p) (:domain docks) (:objects c1 c2 - crate p1 p2 p3 - place)
  (:init (at c1 p1) (at c2 p2) (next p1 p2) (next p2 p3) (shut p3))
  (:goal (forall (?c - crate) (at ?c p3))))
"""


def peers_operators(folder, domain, problem):
    """Names of the operators that the translator reaches."""
    (folder / "domain.pddl").write_text(domain)
    (folder / "problem.pddl").write_text(problem)
    files = [str(folder / "domain.pddl"), str(folder / "problem.pddl")]
    options.set_options(files)
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # it leaves its files open
        task = peer_parser.open(*files)
        normalize.normalize(task)
        reached = instantiate.explore(task)
    return {tuple(action.name.strip("()").split()) for action in reached[2]}


def own_operators(problem):
    task = ground(problem)
    return {task.action(operator) for operator in range(task.num_operators)}


@pytest.mark.parametrize(
    ("domain", "problem"),
    [(LOGISTICS, LOGISTICS_PROBLEM), (DOCKS, DOCKS_PROBLEM)],
    ids=["logistics", "docks"],
)
def test_same_operators(domain, problem, tmp_path):
    own = own_operators(parse_problem(problem, parse_domain(domain)))
    assert own == peers_operators(tmp_path, domain, problem)
    assert len(own) > 10


def repeats_a_variable(atom):
    """The translator (26.6) reaches too much where a condition such as ``(f ?x ?x)`` is the only one."""
    variables = [term for term in atom.terms if term.startswith("?")]
    return len(set(variables)) < len(variables)


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(st.randoms(use_true_random=True))
def test_same_operators_on_random_strips(tmp_path, rng):
    problem = ProblemMaker(rng, strips=True).problem()
    assume(not any(repeats_a_variable(part) for a in problem.domain.actions for part in a.precondition.parts))
    theirs = peers_operators(tmp_path, format_domain(problem.domain), format_problem(problem))
    assert own_operators(problem) == theirs

"""Domains that a stranger might bring: odd, but right. Each has an optimal plan of known cost, or none."""

import pytest

from explicable.model.grounding import ground
from explicable.pddl import parse_domain, parse_problem
from explicable.search import Outcome, search

DOMAIN = "(define (domain d) (:requirements :adl :typing :action-costs) {})"
PROBLEM = "(define (problem p) (:domain d) (:objects {}) (:init {}) (:goal {}) {})"

CHAIN = " ".join(f"(n ?x{i} ?x{i + 1})" for i in range(59))
LINKS = " ".join(f"(n o{i} o{i + 1})" for i in range(59))
METRIC = "(:metric minimize (total-cost))"

ODDITIES = {
    "either under forall in an effect": (
        "(:types a b c) (:predicates (q ?x - (either a b)))"
        "(:action go :parameters () :effect (forall (?y - (either a b)) (q ?y)))",
        ("x - a y - b z - c", "", "(and (q x) (q y))", ""),
        1,
    ),
    "an object of two types": (
        "(:types a b) (:predicates (p ?x - a) (q ?x - b))"
        "(:action go :parameters (?x - a)"
        " :precondition (exists (?y - b) (and (= ?x ?y) (q ?y))) :effect (p ?x))",
        ("o - (either a b) only - a", "(q o)", "(p o)", ""),
        1,
    ),
    "quantifiers in one another": (
        "(:predicates (r ?x ?y) (s ?x) (win)) (:action make :parameters (?x ?y) :effect (r ?x ?y))"
        "(:action win :parameters () :effect (win) :precondition"
        " (forall (?x) (exists (?y) (and (r ?x ?y) (forall (?z) (imply (s ?z) (not (= ?z ?y))))))))",
        ("a b", "(s b)", "(win)", ""),
        3,
    ),
    "a disjunction as the condition of an effect": (
        "(:predicates (p) (q) (r) (g)) (:action b :parameters () :effect (q))"
        "(:action c :parameters () :effect (not (r)))"
        "(:action a :parameters () :effect (when (or (p) (and (q) (not (r)))) (and (g) (not (q)))))",
        ("", "(r)", "(and (g) (not (q)))", ""),
        3,
    ),
    "a quantified variable that hides a parameter": (
        "(:predicates (p ?x) (q ?x))"
        "(:action a :parameters (?x) :precondition (exists (?x) (p ?x)) :effect (q ?x))",
        ("m n", "(p n)", "(q m)", ""),
        1,
    ),
    "a constant, nobody's object": (
        "(:types t) (:constants k - t) (:predicates (p ?x - t)) (:action a :parameters () :effect (p k))",
        ("", "", "(p k)", ""),
        1,
    ),
    "forall over a type without objects": (
        "(:types t) (:predicates (p ?x - t) (w))"
        "(:action a :parameters () :precondition (forall (?x - t) (p ?x)) :effect (w))",
        ("", "", "(w)", ""),
        1,
    ),
    "exists over a type without objects": (
        "(:types t) (:predicates (p ?x - t) (w))"
        "(:action a :parameters () :precondition (exists (?x - t) (p ?x)) :effect (w))",
        ("", "", "(w)", ""),
        None,
    ),
    "a disjunction of nothing": ("(:predicates (p))", ("", "(p)", "(or)", ""), None),
    "a goal of nothing": ("(:predicates (p))", ("", "", "()", ""), 0),
    "costs by arguments, one of them zero, one missing": (
        "(:predicates (at ?x)) (:functions (total-cost) - number (way ?a ?b) - number)"
        "(:action go :parameters (?a ?b) :precondition (at ?a)"
        " :effect (and (at ?b) (not (at ?a)) (increase (total-cost) (way ?a ?b))))",
        ("a b c", "(at a) (= (way a b) 0) (= (way b c) 3)", "(at c)", METRIC),
        3,
    ),
    "steps that cost nothing": (
        "(:predicates (w) (v)) (:functions (total-cost)) (:action free :parameters () :effect (w))"
        "(:action go :parameters () :precondition (w) :effect (and (v) (increase (total-cost) 0)))",
        ("", "", "(v)", METRIC),
        0,
    ),
    "sixty parameters": (
        f"(:predicates (n ?x ?y) (g)) (:action a :parameters ({' '.join(f'?x{i}' for i in range(60))})"
        f" :precondition (and {CHAIN}) :effect (g))",
        (" ".join(f"o{i}" for i in range(60)), LINKS, "(g)", ""),
        1,
    ),
    "names that are keywords elsewhere": (
        "(:predicates (at ?x) (define))"
        "(:action problem :parameters (?when) :effect (and (at ?when) (define)))",
        ("and or domain", "", "(and (at and) (at domain) (define))", ""),
        2,
    ),
    "names in other scripts, and numbers as names": (
        "(:predicates (gültig ?tür)) (:action öffne-1 :parameters (?tür) :effect (gültig ?tür))",
        ("門 2.5", "", "(and (gültig 門) (gültig 2.5))", ""),
        2,
    ),
    "one fact added and deleted by one action": (
        "(:predicates (p ?x) (q)) (:action g :parameters (?x ?y) :effect (and (not (p ?x)) (p ?y) (q)))",
        ("a", "", "(and (p a) (q))", ""),
        1,
    ),
}


def optimum(domain, problem):
    result = search(ground(parse_problem(problem, parse_domain(domain))), "astar")
    assert result.outcome in {Outcome.SOLVED, Outcome.UNSOLVABLE}
    return result.cost


@pytest.mark.parametrize("name", ODDITIES)
def test_odd_domains(name):
    domain, parts, cost = ODDITIES[name]
    assert optimum(DOMAIN.format(domain), PROBLEM.format(*parts)) == cost


@pytest.mark.parametrize("end", ["\r\n", "\r", "\t\n", "\u2003"])
def test_odd_white_space_and_a_byte_order_mark(end):
    domain, parts, cost = ODDITIES["names in other scripts, and numbers as names"]
    texts = (DOMAIN.format(domain), PROBLEM.format(*parts))
    assert optimum(*("\ufeff" + text.replace(" ", end) for text in texts)) == cost

"""Our reader against that of `unified-planning`: on the same text, and on text that our writer wrote."""

import pytest
from unified_planning.io import PDDLReader
from unified_planning.shortcuts import get_environment

from explicable.model.problem import ancestors
from explicable.pddl import format_domain, format_problem, parse_domain, parse_problem

PAIRS = {
    "untyped": (
        """(define (domain gripper) (:predicates (room ?r) (ball ?b) (at-robby ?r) (at ?b ?r) (holding ?b))
        (:action move :parameters (?a ?b) :precondition (and (room ?a) (room ?b) (at-robby ?a))
            :effect (and (at-robby ?b) (not (at-robby ?a))))
        (:action pick :parameters (?b ?r) :precondition (and (ball ?b) (room ?r) (at ?b ?r) (at-robby ?r))
            :effect (and (holding ?b) (not (at ?b ?r)))))""",
        """(define (problem one) (:domain gripper) (:objects kitchen hall ball1)
        (:init (room kitchen) (room hall) (ball ball1) (at ball1 hall) (at-robby kitchen))
        (:goal (and (holding ball1) (at-robby kitchen))))""",
    ),
    "typed, with costs": (
        """(define (domain delivery) (:requirements :typing :action-costs)
        (:types van truck - vehicle vehicle place - object) (:constants depot - place)
        (:predicates (at ?v - vehicle ?p - place) (road ?a ?b - place))
        (:functions (total-cost) - number (length ?a ?b - place) - number)
        (:action drive :parameters (?v - vehicle ?a ?b - place) :precondition (and (at ?v ?a) (road ?a ?b))
            :effect (and (at ?v ?b) (not (at ?v ?a)) (increase (total-cost) (length ?a ?b)))))""",
        """(define (problem tour) (:domain delivery) (:objects home - place t1 - truck v1 - van)
        (:init (at t1 depot) (at v1 home) (road depot home) (= (total-cost) 0) (= (length depot home) 4))
        (:goal (at t1 home)) (:metric minimize (total-cost)))""",
    ),
    "all of ADL": (
        """(define (domain office) (:requirements :adl) (:types room item - object)
        (:predicates (at ?r - room) (lies ?i - item ?r - room) (carried ?i - item) (locked ?r - room))
        (:action go :parameters (?from ?to - room)
            :precondition (and (at ?from) (not (= ?from ?to)) (not (locked ?to)))
            :effect (and (at ?to) (not (at ?from))
                (forall (?i - item) (when (carried ?i) (and (lies ?i ?to) (not (lies ?i ?from)))))))
        (:action take :parameters (?i - item ?r - room)
            :precondition (and (at ?r) (lies ?i ?r) (or (locked ?r) (forall (?j - item) (not (carried ?j)))))
            :effect (carried ?i)))""",
        """(define (problem letters) (:domain office) (:objects hall study - room letter pen - item)
        (:init (at hall) (lies letter hall) (lies pen study))
        (:goal (and (lies letter study) (exists (?i - item) (carried ?i)))))""",
    ),
}


def peer_view(domain_text, problem_text):
    """What the peer read, as sorted names."""
    get_environment().credits_stream = None
    task = PDDLReader().parse_problem_string(domain_text, problem_text)
    values = task.explicit_initial_values.items()
    return {
        "objects": sorted(
            (o.name, sorted({o.type.name, *(t.name for t in o.type.ancestors)})) for o in task.all_objects
        ),
        "actions": sorted(
            (a.name, [p.name for p in a.parameters], [p.type.name for p in a.parameters], len(a.effects))
            for a in task.actions
        ),
        "init": sorted((f.fluent().name, *map(str, f.args)) for f, v in values if v.is_true()),
        "values": sorted(
            (f.fluent().name, *map(str, f.args), v.constant_value()) for f, v in values if v.is_int_constant()
        ),
        "num_goals": len(task.goals),
    }


def our_view(problem):
    """What we read, in the same form."""
    domain = problem.domain
    above = ancestors(domain.types)
    objects = {**domain.constants, **problem.objects}
    return {
        "objects": sorted(
            (name, sorted(above[kind] - {"object"}) or ["object"]) for name, (kind,) in objects.items()
        ),
        "actions": sorted(
            (a.name, [p.name[1:] for p in a.parameters], [p.types[0] for p in a.parameters], len(a.effects))
            for a in domain.actions
        ),
        "init": sorted(problem.init),
        "values": sorted((*t, value) for t, value in problem.values.items() if t != ("total-cost",)),
        "num_goals": 1,
    }


@pytest.mark.filterwarnings("ignore::DeprecationWarning:unified_planning")
@pytest.mark.parametrize("name", PAIRS)
def test_both_read_the_same(name):
    domain_text, problem_text = PAIRS[name]
    problem = parse_problem(problem_text, parse_domain(domain_text))
    expected = peer_view(domain_text, problem_text)
    assert our_view(problem) == expected
    assert peer_view(format_domain(problem.domain), format_problem(problem)) == expected

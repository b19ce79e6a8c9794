"""The reader: what it understands."""

import pytest

from explicable.model.problem import (
    TRUE,
    And,
    Atom,
    Effect,
    Exists,
    Forall,
    Function,
    FunctionTerm,
    Not,
    Or,
    Parameter,
    Predicate,
)
from explicable.pddl import parse_domain, parse_problem, read_pair

DOMAIN = """\
(define (domain delivery)
  (:requirements :adl :action-costs)
  (:types truck - vehicle
          vehicle place parcel - object
          van - truck)
  (:constants depot - place)
  (:predicates (at ?v - (either vehicle parcel) ?p - place)
               (road ?from ?to - place)
               (in ?x - parcel ?v - vehicle)
               (empty))
  (:functions (total-cost) - number
              (length ?from ?to - place) - number)
  (:action drive
    :parameters (?t - truck ?from ?to - place)
    :precondition (and (at ?t ?from) (road ?from ?to))
    :effect (and (at ?t ?to) (not (at ?t ?from))
                 (increase (total-cost) (length ?from ?to)) (increase (total-cost) 2))))
"""
PROBLEM = """\
(define (problem tour)
  (:domain delivery)
  (:objects t1 - van
            home - place
            box - parcel)
  (:init (at t1 depot) (road depot home)
         (= (total-cost) 0) (= (length depot home) 7))
  (:goal (and (at t1 home)))
  (:metric minimize (total-cost)))
"""


def parse_action(text, declared="(p) (q ?x) (r ?x ?y)"):
    """The one action of a small domain."""
    domain = parse_domain(
        f"(define (domain d) (:requirements :adl) (:constants c) (:predicates {declared}) (:action a {text}))"
    )
    return domain.actions[0]


def parse_condition(text):
    return parse_action(f":parameters (?x ?y) :precondition {text}").precondition


def test_reads_a_domain():
    domain = parse_domain(DOMAIN)
    assert domain.name == "delivery"
    assert domain.requirements == {":adl", ":action-costs"}
    assert domain.types == {
        "truck": ("vehicle",),
        "vehicle": ("object",),
        "place": ("object",),
        "parcel": ("object",),
        "van": ("truck",),
    }
    assert domain.constants == {"depot": ("place",)}
    assert domain.predicates[0] == Predicate(
        "at", (Parameter("?v", ("vehicle", "parcel")), Parameter("?p", ("place",)))
    )
    assert domain.functions[0] == Function("total-cost", ())
    (drive,) = domain.actions
    assert drive.parameters == (
        Parameter("?t", ("truck",)),
        Parameter("?from", ("place",)),
        Parameter("?to", ("place",)),
    )
    assert drive.precondition == And((Atom("at", ("?t", "?from")), Atom("road", ("?from", "?to"))))
    assert drive.effects == (
        Effect(Atom("at", ("?t", "?to"))),
        Effect(Atom("at", ("?t", "?from")), positive=False),
    )
    assert drive.cost == (FunctionTerm("length", ("?from", "?to")), 2)


def test_reads_a_problem():
    domain = parse_domain(DOMAIN)
    problem = parse_problem(PROBLEM, domain)
    assert problem.name == "tour"
    assert problem.domain is domain
    assert problem.objects == {"t1": ("van",), "home": ("place",), "box": ("parcel",)}
    assert problem.init == (("at", "t1", "depot"), ("road", "depot", "home"))
    assert problem.goal == And((Atom("at", ("t1", "home")),))
    assert problem.values == {("total-cost",): 0, ("length", "depot", "home"): 7}
    assert problem.minimize_cost


def test_reads_files(tmp_path):
    (tmp_path / "domain.pddl").write_text("\ufeff; Straße\r\n" + DOMAIN)
    (tmp_path / "problem.pddl").write_text(PROBLEM)
    assert read_pair(tmp_path / "domain.pddl", tmp_path / "problem.pddl") == parse_problem(
        PROBLEM, parse_domain(DOMAIN)
    )


def test_letter_case_and_comments_do_not_matter():
    loud = DOMAIN.upper().replace("\n", " ; a (comment; with ( brackets\r\n")
    assert parse_domain(loud) == parse_domain(DOMAIN)


def test_sections_may_stand_in_any_order():
    actions_first = (
        "(define (domain d) (:action a :parameters (?x - t) :precondition (p ?x c))"
        " (:predicates (p ?x ?y - t)) (:constants c - t) (:types t) (:requirements :typing))"
    )
    assert parse_domain(actions_first).actions[0].precondition == Atom("p", ("?x", "c"))
    domain = parse_domain(DOMAIN)
    swapped = PROBLEM.replace("(:domain delivery)\n", "").replace("(:goal", "(:domain delivery) (:goal")
    assert parse_problem(swapped, domain) == parse_problem(PROBLEM, domain)


def test_tokens_need_no_spaces_between_them():
    action = parse_action(":parameters(?x?y):precondition(and(r?x?y)(q c)):effect(not(r?x?y))")
    assert action.precondition == And((Atom("r", ("?x", "?y")), Atom("q", ("c",))))
    assert action.effects == (Effect(Atom("r", ("?x", "?y")), positive=False),)
    domain = parse_domain(
        "(define(domain d)(:requirements :typing)(:types a-b -object c -a-b d -(either c a-b)))"
    )
    assert domain.types == {"a-b": ("object",), "c": ("a-b",), "d": ("c", "a-b")}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("()", TRUE),
        ("(and)", TRUE),
        ("(or)", Or()),
        ("(p)", Atom("p", ())),
        ("(not (= ?x c))", Not(Atom("=", ("?x", "c")))),
        ("(or (p) (q ?x))", Or((Atom("p", ()), Atom("q", ("?x",))))),
        ("(imply (p) (q ?x))", Or((Not(Atom("p", ())), Atom("q", ("?x",))))),
        ("(exists (?z) (r ?z ?x))", Exists((Parameter("?z"),), Atom("r", ("?z", "?x")))),
        ("(forall (?x ?z - object) (q ?x))", Forall((Parameter("?x"), Parameter("?z")), Atom("q", ("?x",)))),
    ],
)
def test_reads_conditions(text, expected):
    assert parse_condition(text) == expected


def test_effects_are_flattened():
    action = parse_action(
        """:parameters (?x)
           :effect (and (p) (and (q ?x))
                        (forall (?y) (and (r ?x ?y) (when (q ?y) (and (p) (not (r ?y ?x)))))))"""
    )
    q, y = Atom("q", ("?y",)), (Parameter("?y"),)
    assert action.effects == (
        Effect(Atom("p", ())),
        Effect(Atom("q", ("?x",))),
        Effect(Atom("r", ("?x", "?y")), parameters=y),
        Effect(Atom("p", ()), condition=q, parameters=y),
        Effect(Atom("r", ("?y", "?x")), positive=False, condition=q, parameters=y),
    )


def test_requirements_default_to_strips():
    assert parse_domain("(define (domain d))").requirements == {":strips"}


def test_a_type_may_get_its_parent_later():
    domain = parse_domain("(define (domain d) (:requirements :typing) (:types a b - object b - a))")
    assert domain.types == {"a": ("object",), "b": ("a",)}


def test_initial_atoms_count_once_and_denials_mean_nothing():
    domain = parse_domain(DOMAIN)
    text = PROBLEM.replace("(:init", "(:init (not (at t1 home)) (at  t1 depot) (not (empty))")
    assert parse_problem(text, domain) == parse_problem(PROBLEM, domain)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("(:types t)", ["1:20: ':typing' is used but not required"]),
        ("(:predicates (p ?x - object ?y - object))", ["1:39: ':typing' is used but not required"]),
        (
            "(:predicates (p)) (:action a :precondition (or (not (p)) (not (p))))",
            [
                "1:64: ':disjunctive-preconditions' is used but not required",
                "1:68: ':negative-preconditions' is used but not required",
            ],
        ),
        (
            "(:predicates (p)) (:action a :parameters (?x) :precondition (exists (?y) (= ?x ?y))"
            " :effect (when (p) (not (p))))",
            [
                "1:81: ':existential-preconditions' is used but not required",
                "1:94: ':equality' is used but not required",
                "1:113: ':conditional-effects' is used but not required",
            ],
        ),
    ],
)
def test_warns_of_features_that_are_not_required(text, expected):
    warnings = []
    text = f"(define (domain d) {text})"
    parse_domain(text, warn=lambda warning: warnings.append(str(warning)))
    assert warnings == expected

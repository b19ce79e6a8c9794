"""Broken and unsupported PDDL: one message that says where and what."""

import pytest

from explicable.errors import PDDLError, UnsupportedFeatureError
from explicable.pddl import format_domain, parse_domain, parse_problem, read_domain

DOMAIN = """\
(define (domain delivery)
  (:requirements :adl :action-costs)
  (:types vehicle place parcel - object
          truck - vehicle)
  (:constants depot - place)
  (:predicates (at ?v - (either vehicle parcel) ?p - place)
               (road ?from ?to - place)
               (empty))
  (:functions (total-cost) - number
              (length ?from ?to - place) - number)
  (:action drive
    :parameters (?t - truck ?from ?to - place)
    :precondition (and (at ?t ?from) (road ?from ?to))
    :effect (and (at ?t ?to) (increase (total-cost) 3))))
"""
PROBLEM = """\
(define (problem tour)
  (:domain delivery)
  (:objects t1 - truck
            home - place
            box - parcel)
  (:init (at t1 depot)
         (road depot home)
         (= (total-cost) 0))
  (:goal (and (at t1 home)))
  (:metric minimize (total-cost)))
"""


def spoil(text, old, new):
    """Replace a piece of text; give the result, and the line and column where `new` has its ``@``."""
    assert text.count(old) == 1
    before, after = (text.replace(old, new)).split("@")
    return before + after, f"{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}"


BAD_DOMAINS = [
    # Brackets and the frame.
    ("(define (domain delivery)\n  (", "(@", "expected 'define', not ':requirements'"),
    ("(define (domain delivery)\n  (", "@", "expected '(define ...)', not ':requirements'"),
    ("(define (domain", "(@defin (domain", "expected 'define', not 'defin'"),
    ("(domain delivery)", "(@problem delivery)", "expected 'domain', not 'problem'"),
    ("(domain delivery)", "(domain@)", "expected the domain's name, not ')'"),
    ("(:types", "@types (:types", "unexpected 'types'"),
    ("(:types", "(@types", "expected a section of a domain, not 'types'"),
    ("(:types", "(@:objects", "expected a section of a domain, not ':objects'"),
    ("(:constants depot - place)", "(:constants) (@:constants)", "':constants' is given twice"),
    ("(empty))\n  ", "(empty)\n  @", "a ')' is missing before ':functions'"),
    (
        "(increase (total-cost) 3))))\n",
        "(increase (total-cost) 3))))@)",
        "')' without a '(' before it",
    ),
    (
        "(empty))\n  (:functions",
        "(empty))) @(:functions",
        "text after the end of '(define ...)': is there a ')' too many?",
    ),
    # Types.
    ("truck - vehicle)", "@truck - car)", "undeclared type 'car', the parent of 'truck'"),
    ("truck - vehicle)", "truck - vehicle @truck - place)", "type 'truck' is declared twice"),
    ("truck - vehicle)", "@a - b b - c c - a)", "type 'a' is its own ancestor"),
    ("truck - vehicle)", "@truck - truck)", "type 'truck' is its own ancestor"),
    ("truck - vehicle)", "@object - truck)", "type 'object' can't have a parent"),
    ("truck - vehicle)", "truck -@)", "expected a type, not ')'"),
    ("(either vehicle parcel)", "(either@)", "expected a type, not ')'"),
    ("(either vehicle parcel)", "(@or vehicle parcel)", "expected a type or '(either ...)', not 'or'"),
    # Names.
    ("depot - place", "depot - @city", "undeclared type 'city'"),
    ("depot - place", "depot @depot - place", "constant 'depot' is declared twice"),
    ("depot - place", "@?depot - place", "expected a constant, not '?depot'"),
    ("(empty)", "(@at ?x)", "predicate 'at' is declared twice"),
    ("(empty)", "(empty @x)", "expected a variable, not 'x'"),
    ("(empty)", "(empty @?)", "expected a variable, not '?'"),
    ("(empty)", "@empty", "expected '(', not 'empty'"),
    ("(empty)", "(@= ?x ?y)", "a predicate can't be named '='"),
    ("(empty)", "(@or ?x ?y)", "a predicate can't be named 'or'"),
    ("(total-cost) - number", "(total-cost) (@total-cost)", "function 'total-cost' is declared twice"),
    ("(:action drive", "(:action drive) (:action @drive", "action 'drive' is declared twice"),
    ("(:action drive", "(:action @:parameters", "expected the action's name, not ':parameters'"),
    # Actions.
    (":parameters (?t", ":parameters (@t", "expected a variable, not 't'"),
    ("?t - truck ?from ?to - place)", "?t ?from @?t)", "parameter '?t' is declared twice"),
    (":precondition", ":precondition () @:precondition", "':precondition' is given twice"),
    (
        ":precondition",
        "@:preconditions",
        "expected ':parameters', ':precondition' or ':effect', not ':preconditions'",
    ),
    (
        ":parameters (?t - truck ?from ?to - place)",
        ":effect () @:parameters ()",
        "':parameters' has to come first",
    ),
    # Atoms.
    ("(at ?t ?from)", "(@on ?t ?from)", "undeclared predicate 'on'"),
    ("(at ?t ?from)", "(@at ?t)", "'at' takes 2 arguments, not 1"),
    ("(at ?t ?from)", "(@empty ?t)", "'empty' takes 0 arguments, not 1"),
    ("(at ?t ?from)", "(@= ?t)", "'=' takes 2 arguments, not 1"),
    ("(at ?t ?from)", "(at ?t @?where)", "unbound variable '?where'"),
    ("(at ?t ?from)", "(at ?t @harbour)", "undeclared object 'harbour'"),
    ("(at ?t ?from)", "(at ?t @(road))", "expected a variable or an object, not '('"),
    ("(at ?t ?from)", "(at ?t @?t)", "'?t' is of type 'truck', but argument 2 of 'at' is of type 'place'"),
    (
        "(at ?t ?from)",
        "(at @depot ?from)",
        "'depot' is of type 'place', but argument 1 of 'at' is of type '(either vehicle parcel)'",
    ),
    (
        "(at ?t ?from)",
        "(exists (?x - (either parcel place)) (at @?x ?from))",
        "'?x' is of type '(either parcel place)', but argument 1 of 'at'"
        " is of type '(either vehicle parcel)'",
    ),
    (
        "(at ?t ?from)",
        "(exists (?x) (road ?from @?x))",
        "'?x' is of type 'object', but argument 2 of 'road' is of type 'place'",
    ),
    ("(at ?t ?from)", "(forall (?x @?x) (empty))", "parameter '?x' is declared twice"),
    ("(at ?t ?from)", "(not (empty) @(empty))", "expected ')', not '('"),
    ("(at ?t ?from)", "(imply (empty)@)", "expected '(', not ')'"),
    ("(at ?t ?from)", "(@when (empty) (empty))", "'when' can't stand here"),
    ("(at ?t ?from)", "(@-5)", "expected a predicate, not '-5'"),
    # Effects.
    ("(at ?t ?to)", "(@or (at ?t ?to))", "'or' can't stand here"),
    ("(at ?t ?to)", "(not (@not (at ?t ?to)))", "'not' can't stand here"),
    ("(at ?t ?to)", "(@= ?t ?to)", "'=' can't stand here"),
    ("(at ?t ?to)", "(when (empty) (@when (empty) (empty)))", "'when' can't stand inside 'when'"),
    ("(at ?t ?to)", "(when (empty) (@forall (?x) (empty)))", "'forall' can't stand inside 'when'"),
    ("(at ?t ?to)", "(forall (?x) (@forall (?x) (empty)))", "parameter '?x' is declared twice"),
    ("(total-cost) 3", "(total-cost) @-3", "negative cost -3"),
    ("(total-cost) 3", "(total-cost) @three", "expected a number, not 'three'"),
    ("(total-cost) 3", "(total-cost) (@weight ?t)", "undeclared function 'weight'"),
    (
        "(total-cost) 3",
        "(total-cost) (length ?from @?t)",
        "'?t' is of type 'truck', but argument 2 of 'length' is of type 'place'",
    ),
    ("(total-cost) 3", "(total-cost) @2147483648", "2147483648 is too large for a cost (at most 2147483647)"),
    (
        "(and (at ?t ?to) (increase (total-cost) 3)",
        "@(and (at ?t ?to) (increase (total-cost) 2147483647) (increase (total-cost) 1)",
        "costs that add up to more than 2147483647",
    ),
]

BAD_PROBLEMS = [
    ("(:domain delivery)", "(:domain @deliveries)", "the problem is for domain 'deliveries', not 'delivery'"),
    ("(problem tour)", "(@domain tour)", "expected 'problem', not 'domain'"),
    (
        "(define (problem tour)\n  (:domain delivery)",
        "@(define (problem tour)",
        "the problem has no '(:domain ...)'",
    ),
    ("home - place", "home - @city", "undeclared type 'city'"),
    ("home - place", "home - place @t1", "object 't1' is declared twice"),
    (
        "home - place",
        "home @depot - place",
        "object 'depot' is declared twice (it is a constant of the domain)",
    ),
    ("(road depot home)", "(@path depot home)", "undeclared predicate 'path'"),
    ("(road depot home)", "(@road depot)", "'road' takes 2 arguments, not 1"),
    ("(road depot home)", "(road depot @house)", "undeclared object 'house'"),
    ("(road depot home)", "(road depot @?x)", "unbound variable '?x'"),
    (
        "(road depot home)",
        "(road depot @box)",
        "'box' is of type 'parcel', but argument 2 of 'road' is of type 'place'",
    ),
    ("(road depot home)", "(road depot @(home))", "expected a variable or an object, not '('"),
    ("(road depot home)", "@road", "expected ')', not 'road'"),
    ("(road depot home)", "(@)", "expected a predicate, not ')'"),
    ("(road depot home)", "(@and (road depot home))", "'and' can't stand here"),
    ("(road depot home)", "(@= depot home)", "'=' can't stand here"),
    ("(road depot home)", "@(not (at t1 depot))", "(at t1 depot) is both true and false in ':init'"),
    ("(= (total-cost) 0)", "(= (length depot home) @-1)", "negative cost -1"),
    ("(= (total-cost) 0)", "(= (@weight depot) 1)", "undeclared function 'weight'"),
    (
        "(= (total-cost) 0)",
        "(= (length depot home) 1) (= (length depot home) @2)",
        "(length depot home) has two values in ':init'",
    ),
    ("(and (at t1 home))", "(and (at t1 home)) @(empty)", "expected ')', not '('"),
    ("minimize (total-cost)", "@shrink (total-cost)", "expected 'minimize' or 'maximize'"),
    ("(:goal (and (at t1 home)))", "(@:gaol)", "expected a section of a problem, not ':gaol'"),
    ("(:goal (and (at t1 home)))", "(:goal@)", "expected '(', not ')'"),
]

UNSUPPORTED_IN_DOMAINS = [
    (":adl", "@:durative-actions", "requirement ':durative-actions' is not supported"),
    (":adl", "@:derived-predicates", "requirement ':derived-predicates' is not supported"),
    (":adl", ":adl @:preferences", "requirement ':preferences' is not supported"),
    ("(:action drive", "(@:durative-action drive", "durative actions (':durative-action') are not supported"),
    (
        "(:action drive",
        "(@:derived (empty)) (:action drive",
        "derived predicates (':derived') are not supported",
    ),
    ("(:action drive", "(@:constraints) (:action drive", "constraints (':constraints') are not supported"),
    (
        "(length ?from ?to - place) - number",
        "(length ?from) - @place",
        "functions other than numbers are not supported",
    ),
    (":precondition", "@:vars () :precondition", "':vars' of an action is not supported"),
    ("(at ?t ?from)", "(@>= (length ?from ?to) 3)", "numeric conditions ('>=') are not supported"),
    ("(at ?t ?from)", "(@= (total-cost) 3)", "numeric conditions are not supported"),
    ("(at ?t ?from)", "(@preference p (empty))", "preferences ('preference') are not supported"),
    ("(at ?t ?from)", "(@sometime (empty))", "trajectory constraints ('sometime') are not supported"),
    ("(at ?t ?to)", "(@oneof (empty))", "uncertain effects or facts ('oneof') are not supported"),
    (
        "(at ?t ?to)",
        "(@assign (total-cost) 3)",
        "numeric effects other than on 'total-cost' ('assign') are not supported",
    ),
    (
        "(increase (total-cost) 3)",
        "(@increase (length ?from ?to) 3)",
        "numeric effects other than on 'total-cost' ('increase') are not supported",
    ),
    (
        "(increase (total-cost) 3)",
        "(when (empty) (@increase (total-cost) 3))",
        "conditional costs are not supported",
    ),
    ("(total-cost) 3", "(total-cost) @2.5", "decimal costs (2.5) are not supported"),
    ("(total-cost) 3", "(total-cost) (@* 2 (length ?from ?to))", "arithmetic ('*') is not supported"),
    (
        "(total-cost) 3",
        "(total-cost) @(total-cost)",
        "a cost that depends on 'total-cost' is not supported",
    ),
]

UNSUPPORTED_IN_PROBLEMS = [
    ("(road depot home)", "@(at 5 (road depot home))", "timed initial literals ('at') are not supported"),
    ("(= (total-cost) 0)", "(= (length depot home) @0.5)", "decimal costs (0.5) are not supported"),
    (
        "minimize (total-cost)",
        "@maximize (total-cost)",
        "metrics other than 'minimize (total-cost)' are not supported",
    ),
    (
        "minimize (total-cost)",
        "@minimize (total-time)",
        "metrics other than 'minimize (total-cost)' are not supported",
    ),
    ("(:metric", "(@:constraints) (:metric", "constraints (':constraints') are not supported"),
    ("(and (at t1 home))", "(@preference p (at t1 home))", "preferences ('preference') are not supported"),
]


@pytest.mark.parametrize(("old", "new", "message"), BAD_DOMAINS)
def test_bad_domains(old, new, message):
    text, place = spoil(DOMAIN, old, new)
    with pytest.raises(PDDLError) as caught:
        parse_domain(text, "domain.pddl")
    assert str(caught.value) == f"domain.pddl:{place}: {message}"
    assert caught.type is PDDLError


@pytest.mark.parametrize(("old", "new", "message"), BAD_PROBLEMS)
def test_bad_problems(old, new, message):
    text, place = spoil(PROBLEM, old, new)
    with pytest.raises(PDDLError) as caught:
        parse_problem(text, parse_domain(DOMAIN), "problem.pddl")
    assert str(caught.value) == f"problem.pddl:{place}: {message}"
    assert caught.type is PDDLError


@pytest.mark.parametrize(("old", "new", "message"), UNSUPPORTED_IN_DOMAINS)
def test_unsupported_domains(old, new, message):
    text, place = spoil(DOMAIN, old, new)
    with pytest.raises(UnsupportedFeatureError) as caught:
        parse_domain(text, "domain.pddl")
    assert str(caught.value) == f"domain.pddl:{place}: {message}"


@pytest.mark.parametrize(("old", "new", "message"), UNSUPPORTED_IN_PROBLEMS)
def test_unsupported_problems(old, new, message):
    text, place = spoil(PROBLEM, old, new)
    with pytest.raises(UnsupportedFeatureError) as caught:
        parse_problem(text, parse_domain(DOMAIN), "problem.pddl")
    assert str(caught.value) == f"problem.pddl:{place}: {message}"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "1:1: expected '(define ...)', not the end of the file"),
        ("; nothing but\n; comments", "2:1: expected '(define ...)', not the end of the file"),
        ("(define)", "1:2: expected '(domain ...)' after 'define'"),
        ("(define (domain d)", "1:1: this '(' is never closed"),
        ("(define (domain d) (:types a", "1:20: this '(' is never closed"),
        ("(define (domain d)\r\n(:types\ra -", "2:1: this '(' is never closed"),
        ("(define (domain d)\r\n(:types\ra - b))", "3:1: undeclared type 'b', the parent of 'a'"),
        ("\ufeff(define (domain Straße) (İ))", "1:26: expected a section of a domain, not 'İ'"),
        ("(define (domain d) (\x1b[31m\0))", "1:21: expected a section of a domain, not '\\x1b[31m\\x00'"),
        ("(" * 10_000_000, "1:2: expected 'define', not '('"),
        ("(define " + "(" * 10_000_000, "1:108: lists are nested deeper than 100"),
        ("(define (domain d) " + "()" * 5_000_000, "1:21: expected a section of a domain, not ')'"),
        (
            "(define (domain d) (:action a :precondition " + "(not " * 100 + ")" * 102,
            "1:535: lists are nested deeper than 100",
        ),
        (
            f"(define (domain d) (:types {' '.join(f't{i} - t{i + 1}' for i in range(5000))} t5000))",
            "1:28: types are nested deeper than 100",
        ),
    ],
    ids=lambda value: value[:30],
)
def test_hostile_texts(text, message):
    with pytest.raises(PDDLError) as caught:
        parse_domain(text)
    assert str(caught.value) == message


def test_a_missing_goal_is_named():
    with pytest.raises(PDDLError, match=r"^1:1: the problem has no '\(:goal ...\)'$"):
        parse_problem("(define (problem p) (:domain delivery) (:init))", parse_domain(DOMAIN))


@pytest.mark.parametrize("around", ["(not {})", "(imply (p) {})", "(imply {} (p))", "(exists (?x) {})"])
def test_the_deepest_nesting_allowed_survives(around):
    condition = "(p)"
    for _ in range(97):
        condition = around.format(condition)
    text = "(define (domain d) (:predicates (p)) (:action a :precondition {}))"
    domain = parse_domain(text.format(condition))
    assert parse_domain(format_domain(domain)) == domain
    with pytest.raises(PDDLError, match="nested deeper than"):
        parse_domain(text.format(around.format(around.format(condition))))


def test_a_message_does_not_repeat_a_whole_file():
    with pytest.raises(PDDLError) as caught:
        parse_domain(f"(define (domain d) ({'x' * 1_000_000}))")
    assert len(str(caught.value)) < 500


def test_files_that_cannot_be_read(tmp_path):
    path = tmp_path / "domain.pddl"
    with pytest.raises(PDDLError, match=r"domain.pddl: can't be read: No such file or directory$"):
        read_domain(path)
    with pytest.raises(PDDLError, match=r": can't be read: Is a directory$"):
        read_domain(tmp_path)
    path.write_bytes("(define\n  (domain Straße".encode() + b"\xff")
    with pytest.raises(PDDLError, match=r"domain.pddl:2:17: not UTF-8 text$"):
        read_domain(path)
    path.write_bytes(b"; author: Zo\xeb\n(define (domain d))")
    assert read_domain(path).name == "d"

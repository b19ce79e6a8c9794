"""Differences between two models: all are found, and telling all of them leaves none."""

from pathlib import Path

import pytest

from explicable.model.grounding import ground, ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem, read_team_problem
from explicable.planning.correction import correct
from explicable.planning.differences import find_differences
from labelling.small_teams import courier
from planning.floors import DETOUR, floor

EXAMPLES = Path(__file__).parents[2] / "examples"


def example(name):
    folder = EXAMPLES / name
    files = ("domain.pddl", "problem.pddl", "human-domain.pddl", "human-problem.pddl")
    return read_team_problem(*(folder / file for file in files))


TEAMS = {
    "floor": lambda: floor(DETOUR).problem,
    "courier": courier,
    "rovers": lambda: example("rover-survey"),
    "warehouse": lambda: example("warehouse"),
}

DOMAIN = """(define (domain d) (:requirements :adl :action-costs) (:types robot human spot)
  (:predicates (at ?r - robot ?s - spot) (dark ?s - spot) (lit ?r - robot))
  (:functions (total-cost) (way ?a ?b - spot))
  (:action go :parameters (?r - robot ?a ?b - spot) :precondition {go}
    :effect (and (at ?r ?b) (not (at ?r ?a)) (increase (total-cost) (way ?a ?b)))){more})"""
PROBLEM = """(define (problem p) (:domain d) (:objects r - robot h - human x y - spot{more})
  (:init (at r x) (= (way x y) {way}) (= (total-cost) 0)) (:goal (at r y)) (:metric minimize (total-cost)))"""
LAMP = "(:action light :parameters (?r - robot) :effect (lit ?r))"


def models(own, believed):
    return TeamProblem(
        *(parse_problem(PROBLEM.format(**p), parse_domain(DOMAIN.format(**d))) for d, p in (own, believed))
    )


@pytest.mark.parametrize("make", TEAMS.values(), ids=TEAMS)
def test_told_everything_the_person_knows_everything(make):
    team = make()
    differences = find_differences(team)
    assert differences
    told = correct(team, differences)
    assert find_differences(told) == ()
    assert told.robot is team.robot
    assert ground(told.composite).num_operators == ground(team.composite).num_operators
    own, known = ground_team(TeamProblem(team.robot)).mental, ground_team(told).mental
    assert own.atoms(own.initial_state) == known.atoms(known.initial_state)
    assert own.num_operators == known.num_operators


@pytest.mark.parametrize("make", TEAMS.values(), ids=TEAMS)
def test_told_one_thing_the_person_knows_just_that(make):
    team = make()
    differences = find_differences(team)
    for told in differences:
        left = find_differences(correct(team, [told]))
        assert set(left) <= set(differences)
        assert told not in left


def test_the_rovers_differences_in_words():
    words = [str(difference) for difference in find_differences(example("rover-survey"))]
    assert "(camera-works scout) does not hold" in words
    assert "photograph needs (memory-free ?r)" in words
    assert "photograph makes (not (memory-free ?r))" in words
    assert "send makes (memory-free ?r)" in words


def test_names_of_parameters_numbers_and_whole_actions():
    plain = {"go": "(at ?r ?a)", "more": ""}, {"more": "", "way": 1}
    renamed = parse_domain(DOMAIN.format(go="(at ?r ?a)", more="").replace("?a", "?from"))
    same = TeamProblem(
        parse_problem(PROBLEM.format(more="", way=1), parse_domain(DOMAIN.format(**plain[0]))),
        parse_problem(PROBLEM.format(more="", way=1), renamed),
    )
    assert find_differences(same) == ()
    longer = models(plain, ({"go": "(at ?r ?a)", "more": LAMP}, {"more": "", "way": 7}))
    assert [str(d) for d in find_differences(longer)] == [
        "(way x y) is 1",
        "there is no action (light ?r - robot)",
    ]
    shorter = models(({"go": "(at ?r ?a)", "more": LAMP}, {"more": "", "way": 7}), plain)
    (way, light) = find_differences(shorter)
    assert str(light) == "there is an action (light ?r - robot)"
    assert ("light", "r") in [
        task.action(o)
        for task in [ground(correct(shorter, [light]).mental)]
        for o in range(task.num_operators)
    ]
    assert way.names == {"x", "y"}


def test_a_schema_of_another_form_is_told_whole():
    hidden = "(and (at ?r ?a) (exists (?c - spot) (dark ?c)))"
    own = parse_domain(DOMAIN.format(go=hidden, more=""))
    clashing = parse_domain(DOMAIN.format(go=hidden, more="").replace("?a", "?q").replace("?c", "?a"))
    text = PROBLEM.format(more="", way=1)
    odd = TeamProblem(parse_problem(text, own), parse_problem(text, clashing))
    (difference,) = find_differences(odd)
    assert str(difference).startswith("there is an action (go ?r - robot")
    assert find_differences(correct(odd, [difference])) == ()

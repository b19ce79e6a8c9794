"""The paper's planner, sentence by sentence: Eq. 4 with Viterbi labels, climbing, then best-first search."""

from fractions import Fraction

import numpy as np
import pytest

from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem
from explicable.planning import plan_as_in_paper, plan_explicably
from labelling.small_teams import courier, first_response, random_labeller
from oracles.explicable_search import best_first, climb
from planning.floors import floor

# Two places to survey along a line, on request, with a tank that lasts only in one order.
ROVER = """
(define (domain tank)
  (:requirements :strips :typing)
  (:types robot human place level)
  (:predicates (at ?r - robot ?p - place) (path ?p ?q - place) (tank ?r - robot ?l - level)
    (next ?k ?l - level) (wanted ?p - place) (surveyed ?p - place))
  (:action ask :parameters (?h - human ?p - place) :effect (wanted ?p))
  (:action go :parameters (?r - robot ?p ?q - place ?k ?l - level)
    :precondition (and (at ?r ?p) (path ?p ?q) (tank ?r ?k) (next ?k ?l))
    :effect (and (at ?r ?q) (not (at ?r ?p)) (tank ?r ?l) (not (tank ?r ?k))))
  (:action survey :parameters (?r - robot ?p - place)
    :precondition (and (at ?r ?p) (wanted ?p)) :effect (surveyed ?p)))
"""
ROVER_PROBLEM = """
(define (problem p) (:domain tank)
  (:objects r1 - robot h1 - human a b c d - place l0 l1 l2 l3 l4 - level)
  (:init (at r1 b) (tank r1 l4) (next l4 l3) (next l3 l2) (next l2 l1) (next l1 l0)
    (path a b) (path b a) (path b c) (path c b) (path c d) (path d c))
  (:goal (and (surveyed a) (surveyed d))))
"""


def tank():
    return ground_team(TeamProblem(parse_problem(ROVER_PROBLEM, parse_domain(ROVER)), None))


TEAMS = {
    "hidden": lambda: ground_team(first_response("hidden")),
    "courier": lambda: ground_team(courier()),
    "exclusive": lambda: floor("#######\n#*.@x*#\n#..o..#\n#######\n", "exclusive"),
    "tank": tank,
}


def by_most_probable_labels(team, labeller):
    """F of a path and a relaxed plan, from scratch; human steps are explicable by definition."""
    features = TeamFeatures(team)

    def explicability(steps, length):
        states = [team.task.initial_state]
        for step in steps[:length]:
            states.append(team.task.successor(states[-1], step))
        if not steps:
            return Fraction(1)
        rows = labeller.familiar_features(features.extract(list(steps), states))
        clamp = [True if features.tables.is_human(step) else None for step in steps]
        (labels,) = labeller.model.predict([rows], [clamp])
        return Fraction(labels.count(True), len(labels))

    return explicability


@pytest.mark.parametrize("name", TEAMS)
def test_equation_4_leads_climbing_and_then_best_first_search(name):
    team = TEAMS[name]()
    climbed, alike = [], []
    for seed in range(16):
        labeller = random_labeller(TeamFeatures(team), np.random.default_rng(seed))
        explicability = by_most_probable_labels(team, labeller)
        found = climb(team.task, explicability)
        climbed.append(found is not None)
        by_the_book = best_first(team.task, explicability) if found is None else found
        actions = tuple(map(team.task.action, by_the_book))
        assert plan_as_in_paper(team, labeller).plan.actions == actions
        expected = plan_explicably(team, labeller, algorithm="ff", improve_s=0)
        alike.append(expected.plan.actions == actions)
    assert all(climbed) == (name != "tank")  # there some climbs end where none but best-first search goes on
    assert not all(alike)  # by E[F] other plans come first


@pytest.mark.parametrize("name", TEAMS)
def test_best_first_search_follows_equation_4_with_states_closed_alone(name):
    team = TEAMS[name]()
    for seed in range(4):
        labeller = random_labeller(TeamFeatures(team), np.random.default_rng(seed))
        by_the_book = best_first(team.task, by_most_probable_labels(team, labeller))
        found = plan_explicably(team, labeller, algorithm="eager", expected=False, improve_s=0)
        assert found.plan.actions == tuple(map(team.task.action, by_the_book))

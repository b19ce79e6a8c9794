"""Small team tasks for the tests of this folder, and random walks through them."""

import numpy as np

from explicable.first_response.encoding import encode
from explicable.first_response.map_file import parse_map
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.doubt import with_doubt
from explicable.labelling.labeller import Labeller
from explicable.labelling.learning import CLASSES
from explicable.labelling.traces import LabelledStep, Trace
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem

MAPS = {
    "hidden": ("######", "#@x.*#", "#....#", "#*o..#", "######"),
    "two robots": ("#######", "#@.*.@#", "#.x.o.#", "#*...*#", "#######"),
}

# A courier whose person believes that the lift works; loads are carried and handed over on request.
COURIER = """
(define (domain courier)
  (:requirements :strips :typing)
  (:types robot human place load)
  (:predicates (at ?r - robot ?p - place) (lies ?l - load ?p - place) (holds ?r - robot ?l - load)
    (free ?r - robot) (path ?p ?q - place) (wanted ?l - load) (delivered ?l - load) (desk ?p - place))
  (:action ask :parameters (?h - human ?l - load) :effect (wanted ?l))
  (:action go :parameters (?r - robot ?p ?q - place)
    :precondition (and (at ?r ?p) (path ?p ?q)) :effect (and (at ?r ?q) (not (at ?r ?p))))
  (:action pick :parameters (?r - robot ?l - load ?p - place)
    :precondition (and (at ?r ?p) (lies ?l ?p) (free ?r))
    :effect (and (holds ?r ?l) (not (lies ?l ?p)) (not (free ?r))))
  (:action hand-over :parameters (?r - robot ?l - load ?p - place)
    :precondition (and (at ?r ?p) (desk ?p) (holds ?r ?l) (wanted ?l))
    :effect (and (delivered ?l) (free ?r) (not (holds ?r ?l)))))
"""
COURIER_PROBLEM = """
(define (problem p) (:domain courier)
  (:objects r1 r2 - robot h1 h2 - human a b c d - place x y - load)
  (:init (at r1 a) (at r2 d) (free r1) (free r2) (lies x b) (lies y c) (desk d)
    (path a b) (path b a) (path b c) (path c b) (path c d) (path d c){lift})
  (:goal (and (delivered x) (delivered y))))
"""


def first_response(name: str, semantics: str = "persistent") -> TeamProblem:
    return encode(parse_map("".join(f"{row}\n" for row in MAPS[name])), semantics)


def courier() -> TeamProblem:
    domain = parse_domain(COURIER)
    robot = parse_problem(COURIER_PROBLEM.format(lift=""), domain)
    human = parse_problem(COURIER_PROBLEM.format(lift=" (path a d) (path d a)"), domain)
    return TeamProblem(robot, human)


def problems() -> dict[str, TeamProblem]:
    return {
        "persistent": first_response("hidden"),
        "exclusive": first_response("two robots", "exclusive"),
        "courier": courier(),
    }


def walk(task, rng, num_steps):
    """Operators of a random walk, and the states before and after each."""
    operators, states = [], [task.initial_state]
    for _ in range(num_steps):
        applicable = task.applicable(states[-1])
        if not applicable:
            break
        operators.append(int(rng.choice(applicable)))
        states.append(task.successor(states[-1], operators[-1]))
    return operators, states


def random_trace(problem, rng, num_steps, annotator="anna", team=None):
    """A random walk with random labels; some steps are not asked about."""
    task = (team or ground_team(problem)).task
    operators, _ = walk(task, rng, num_steps)
    steps = []
    for operator in operators:
        action = task.action(operator)
        label = [True, False, None][rng.integers(3)]
        steps.append(LabelledStep(problem.agent_of(action).name, action, label))
    return Trace(problem, tuple(steps), annotator, "simulated")


def random_labeller(team, rng, rounds=20):
    """A labeller with a random weight for most features that random walks with random tails meet.

    Of the others each has the same weight.
    """
    names = set()
    for _ in range(rounds):
        operators, states = walk(team.task, rng, 12)
        tail = rng.integers(team.task.num_operators, size=6).tolist()
        names.update(*team.extract(operators + tail, states))
    features = sorted(names)
    weights = rng.normal(size=(len(features), 2))
    transitions = rng.normal(size=(2, 2))
    known = np.flatnonzero(rng.random(len(features)) < 0.8)
    model = ConditionalRandomField.from_weights(
        CLASSES, [features[number] for number in known], weights[known], transitions
    )
    (model,) = with_doubt([model], 2.0 * rng.random())
    return Labeller(model, schemas=team.schemas)

"""Regret against Dijkstra over the plain mental task; learning and choosing on a domain without a grid."""

import math

import numpy as np
import pytest
from hospital import DOMAIN, hospital

from explicable.execution import mind as minds
from explicable.execution.mind import Mind
from explicable.execution.participants import Participant
from explicable.execution.setting import prepare
from explicable.first_response import encode, generate
from explicable.model.grounding import ground_team
from oracles.costs import cheapest

LOCKED, BELIEVED_LOCKED = ("locked", "hall", "store"), ("locked", "ward", "lab")
FULFILLING = ("visit-room", "fetch")


def problems():
    yield hospital()
    for seed, semantics in enumerate(("exclusive", "persistent")):
        yield encode(generate(np.random.default_rng(seed), height=3, width=3, num_marks=2), semantics)


def oracle_cost(team, state, asked, horizon):
    mental = team.mental
    if horizon == "mission":
        return cheapest(mental, state, mental.is_goal, lambda _: True)
    if asked is None:
        return 0

    def robots(operator):
        return team.problem.agent_of(mental.action(operator)).kind == "robot"

    def done(here):
        actions = map(mental.action, mental.applicable(here))
        return any(action[0] in FULFILLING and action[2] == asked[2] for action in actions)

    return cheapest(mental, state, done, robots) + 1


@pytest.mark.parametrize("problem", list(problems()), ids=["hospital", "exclusive", "persistent"])
@pytest.mark.parametrize("horizon", ["request", "mission"])
def test_regret_is_what_dijkstra_says(problem, horizon):
    """On a random walk that truth and belief both allow, with nothing learnt."""
    team, setting, rng = ground_team(problem), prepare(problem), np.random.default_rng(1)
    participant = Participant("simulated-1", horizon=horizon)
    mind, believed, true = Mind(setting.belief.task.initial_state), team.mental.initial_state, setting.truth
    state, asked = true.task.initial_state, []
    judged = 0
    for _ in range(60):
        actions = [
            action
            for action in map(team.mental.action, team.mental.applicable(believed))
            if true.operator(state, action) is not None
        ]
        if not actions:
            break
        action = actions[rng.integers(len(actions))]
        (operator,) = team.mental.operators_of(action)
        after = team.mental.successor(believed, operator)
        if problem.agent_of(action).kind == "robot":
            current = asked[-1] if asked else None
            fulfils = action[0] in FULFILLING and current is not None and action[2] == current[2]
            best = oracle_cost(team, believed, current, horizon)
            rest = 0 if fulfils and horizon == "request" else oracle_cost(team, after, current, horizon)
            expected = 0 if best == math.inf else 1 + rest - best
            assert minds.regret(setting.belief, participant, mind, action) == expected
            judged += 1
            if action[0] in FULFILLING:
                asked = [request for request in asked if request[2] != action[2]]
        else:
            asked = [action] if problem.robot.domain.name.endswith("exclusive") else [*asked, action]
        next_state = true.task.successor(state, true.operator(state, action))
        mind = minds.watch(setting, mind, action, state, next_state)
        assert (mind.request and mind.request.action) == (asked[-1] if asked else None)
        state, believed = next_state, after
    assert judged > 5


@pytest.fixture
def setting():
    return prepare(hospital())


def after(setting, *actions):
    mind, state = Mind(setting.belief.task.initial_state), setting.truth.task.initial_state
    for action in actions:
        operator = setting.truth.operator(state, action)
        next_state = setting.truth.task.successor(state, operator)
        mind, state = minds.watch(setting, mind, action, state, next_state), next_state
    return mind, state


def believes(setting, mind, atom):
    return setting.belief.task.holds(atom, mind.state)


ASK = ("ask", "nurse", "plaster")
DETOUR = ("go", "robo", "hall", "ward")


def test_only_true_differences_can_be_learnt(setting):
    assert set(setting.differing) == {LOCKED, BELIEVED_LOCKED}
    mind, state = after(setting, ASK)
    assert not believes(setting, mind, LOCKED)
    eager, dull = Participant("simulated-1", learning=1.0), Participant("simulated-2", learning=0.0)
    rng = np.random.default_rng(0)
    assert minds.regret(setting.belief, eager, mind, DETOUR) == 2
    assert minds.infer(setting, dull, mind, state, rng) == mind
    learnt = minds.infer(setting, eager, mind, state, rng)
    assert believes(setting, learnt, LOCKED)
    assert learnt.inferred == ((LOCKED, True),)
    assert (
        minds.regret(setting.belief, eager, learnt, DETOUR) == 0
    )  # no way is left: nothing to hold against it


def test_what_was_inferred_can_be_forgotten(setting):
    mind, state = after(setting, ASK)
    rng = np.random.default_rng(0)
    learnt = minds.infer(setting, Participant("simulated-1", learning=1.0), mind, state, rng)
    assert minds.keep(setting, learnt, [True]) == learnt
    assert minds.keep(setting, learnt, [False]) == mind


def test_seeing_the_impossible_happen_corrects_the_belief(setting):
    mind, _ = after(setting, ASK, DETOUR)
    assert believes(setting, mind, BELIEVED_LOCKED)
    assert (
        minds.regret(setting.belief, Participant("simulated-1"), mind, ("go", "robo", "ward", "lab"))
        == math.inf
    )
    mind, _ = after(setting, ASK, DETOUR, ("go", "robo", "ward", "lab"))
    assert not believes(setting, mind, BELIEVED_LOCKED)
    assert believes(setting, mind, ("in", "robo", "lab"))


def test_unexpected_effects_are_seen():
    falls_shut = DOMAIN.replace(
        "(and (in ?r ?b) (not (in ?r ?a)))", "(and (in ?r ?b) (not (in ?r ?a)) (locked ?a ?b))"
    )
    setting = prepare(hospital(falls_shut))
    mind, _ = after(setting, ASK, DETOUR)
    assert believes(setting, mind, ("locked", "hall", "ward"))
    assert believes(setting, mind, BELIEVED_LOCKED)


def test_a_step_unheard_of_is_inexplicable_and_its_outcome_is_seen():
    lift = """(:action lift :parameters (?r - robot ?a ?b - place) :precondition (in ?r ?a)
              :effect (and (in ?r ?b) (not (in ?r ?a))))"""
    setting = prepare(hospital(DOMAIN.rstrip().removesuffix(")") + lift + ")"))
    up = ("lift", "robo", "hall", "attic")
    mind, _ = after(setting, ASK)
    assert minds.regret(setting.belief, Participant("simulated-1"), mind, up) == math.inf
    mind, _ = after(setting, ASK, up)
    assert believes(setting, mind, ("in", "robo", "attic"))
    assert not believes(setting, mind, ("in", "robo", "hall"))


def test_what_looks_nearest_is_asked_for_first(setting):
    mind, _ = after(setting)
    rng = np.random.default_rng(0)
    for horizon in ("request", "mission"):
        participant = Participant("simulated-1", horizon=horizon)
        assert minds.choose(setting, participant, mind, rng) == ASK
        assert minds.choose(setting, participant, mind, rng, frozenset({ASK})) == ("ask", "nurse", "syringe")


def test_a_request_is_changed_only_for_something_strictly_better(setting):
    mind, _ = after(setting, ("ask", "nurse", "syringe"))
    rng = np.random.default_rng(0)
    assert (
        minds.choose(setting, Participant("simulated-1"), mind, rng) is None
    )  # 3 to go; plaster costs 1 + 2
    mind, _ = after(setting, ASK)
    assert minds.choose(setting, Participant("simulated-1"), mind, rng) is None


def test_with_nothing_asked_for_waiting_is_best_unless_initiative_is_expected(setting):
    mind, _ = after(setting)
    astray, onward = DETOUR, ("go", "robo", "hall", "store")
    expects_waiting = Participant("simulated-1")
    assert minds.regret(setting.belief, expects_waiting, mind, astray) == 1
    expects_initiative = Participant("simulated-1", initiative=True)
    assert minds.regret(setting.belief, expects_initiative, mind, astray) == 2
    assert minds.regret(setting.belief, expects_initiative, mind, onward) == 0


@pytest.mark.parametrize("temperature", [0.5, 2.0])
def test_boltzmann_answers_as_often_as_its_softmax_says(temperature):
    participant = Participant("simulated-1", judgement="boltzmann", temperature=temperature)
    rng = np.random.default_rng(0)
    costs = np.array([3.0, 3.0, 5.0])
    softmax = np.exp(-costs / temperature) / np.exp(-costs / temperature).sum()
    answers = [minds.label_step(participant, costs[2] - costs[0], rng) for _ in range(4000)]
    assert np.mean(answers) == pytest.approx(softmax[2] / softmax[0], abs=0.03)
    assert minds.label_step(participant, 0.0, rng)
    assert not minds.label_step(participant, math.inf, rng)


def test_noise_turns_answers_round():
    rng = np.random.default_rng(0)
    assert not minds.label_step(Participant("simulated-1", noise=1.0), 0.0, rng)

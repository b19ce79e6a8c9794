"""The Boltzmann-rational observer against exhaustive search."""

import math

import numpy as np
import pytest

from explicable.errors import ResourceError, UsageError
from explicable.model.grounding import ground_team
from explicable.planning.beliefs import watch
from explicable.planning.deadline import Deadline
from explicable.planning.observer import CostToGo, recognise, step_probabilities, surprise
from labelling.small_teams import courier, walk
from oracles.costs import cheapest
from planning.floors import DETOUR, command, floor, moves, visit


@pytest.mark.parametrize("temperature", [0.3, 2.0])
def test_step_probabilities_are_the_softmax_of_exhaustive_costs(temperature):
    team = floor("#####\n#@*.#\n#.*.#\n#####\n")
    operators, _ = walk(team.task, np.random.default_rng(2), 8)
    actions = [team.task.action(operator) for operator in operators]
    found = step_probabilities(team, actions, temperature=temperature)
    for action, state, p in zip(actions, watch(team, actions).states, found, strict=False):
        if action[0] == "command":
            assert p is None
            continue
        weights = {}
        for option in team.mental.applicable(state):
            if team.mental.action(option)[0] != "command":
                after = team.mental.successor(state, option)
                to_go = cheapest(team.mental, after, team.mental.is_goal, lambda _: True)
                weights[team.mental.action(option)] = math.exp(-(1 + to_go) / temperature)
        assert p == pytest.approx(weights[action] / sum(weights.values()))


def test_what_is_impossible_for_the_person_surprises_without_bound():
    problem = floor(DETOUR).problem
    team = ground_team(type(problem)(problem.mental, problem.robot))  # here the person is too careful
    probabilities = step_probabilities(team, moves((1, 1), (1, 2)))
    assert probabilities == (0.0,)
    assert surprise(probabilities) == math.inf
    assert surprise([]) == 0


def test_a_best_step_is_the_more_probable_the_colder_the_observer():
    team = floor(DETOUR)
    plan = [command(1, 3), *moves((1, 1), (1, 2))][:1] + moves((1, 1), (2, 1))
    warm, cold = (step_probabilities(team, plan, temperature=t)[1] for t in (10.0, 0.1))
    assert cold < 1e-6 < warm < 0.5


def test_costs_to_go_are_exact_and_end_in_time():
    team = ground_team(courier())
    value = CostToGo(team.mental)
    for state in walk(team.mental, np.random.default_rng(3), 5)[1]:
        assert value(state) == cheapest(team.mental, state, team.mental.is_goal, lambda _: True)
    with pytest.raises(ResourceError):
        CostToGo(team.mental, deadline=Deadline(-1.0))(team.mental.initial_state)


def test_walking_towards_one_room_tells_it_from_the_other():
    team = floor("#######\n#*.@.*#\n#######\n")
    mine, other = ("at", "r1", "c-1-1"), ("at", "r1", "c-1-5")
    team = type(team)(team.problem, team.task.with_goal([mine]), team.mental.with_goal([mine]))
    west = recognise(team, moves((1, 3), (1, 2), (1, 1)), [[other]])
    assert [p for p, _ in west.goal_probabilities] == sorted(p for p, _ in west.goal_probabilities)
    assert west.goal_probabilities[0] == (0.5, 0.5)
    assert west.goal_probabilities[1][0] == pytest.approx(1 / (1 + math.exp(-2)))
    assert west.predictability == (1, 1, 1)
    first, second = (p for p, _ in west.goal_probabilities[1:])
    assert west.legibility == pytest.approx((2 * first + second) / 3)
    astray = recognise(team, moves((1, 3), (1, 4), (1, 3), (1, 2), (1, 1)), [[other]])
    assert astray.legibility < west.legibility
    assert astray.predictability[1] == pytest.approx(math.exp(-2))
    assert recognise(team, [], [[other]]).legibility == 0.5


@pytest.mark.parametrize("temperature", [0.0, -1.0, math.inf, math.nan])
def test_a_temperature_without_meaning_is_refused(temperature):
    team = floor(DETOUR)
    with pytest.raises(UsageError, match="temperature"):
        step_probabilities(team, [visit(1, 3)], temperature=temperature)
    with pytest.raises(UsageError, match="temperature"):
        recognise(team, [], [], temperature=temperature)


def test_a_jump_over_what_is_impossible_for_the_person_is_no_more_than_predictable():
    # The robot passes where the person believes in rubble: nearer to the goal than seemed possible.
    problem = floor(DETOUR).problem
    team = ground_team(type(problem)(problem.mental, problem.robot))
    seen = recognise(team, moves((1, 1), (1, 2), (1, 3)), [[("at", "r1", "c-2-1")]], temperature=1e-3)
    assert seen.predictability == (1, 0, 1)  # within the rubble the person sees no way on
    assert all(sum(row) == pytest.approx(1) for row in seen.goal_probabilities)

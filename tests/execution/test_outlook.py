"""What human steps ask for, and that what is remembered is what a fresh search finds."""

import math

import numpy as np
import pytest
from hospital import DOMAIN, PROBLEM, hospital

from explicable import _core
from explicable.execution.outlook import Outlook
from explicable.execution.setting import prepare
from explicable.execution.stage import build_stage
from explicable.first_response import World, encode, generate
from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem
from explicable.search import search


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
def test_a_command_asks_for_the_visits_of_its_room_by_any_robot(semantics):
    setting = prepare(encode(World(("@*@", "..*")), semantics))
    requests = setting.belief.requests
    assert set(requests) == {("command", "person", "c-0-1"), ("command", "person", "c-1-2")}
    request = requests["command", "person", "c-0-1"]
    assert request.permits == {("commanded", "c-0-1")}
    assert request.fulfilled_by == {("visit-room", "r1", "c-0-1"), ("visit-room", "r2", "c-0-1")}


def test_who_asks_does_not_matter_and_what_everybody_adds_asks_for_nothing():
    two = PROBLEM.format(locked="").replace("nurse - human", "nurse doctor - human")
    everybody = DOMAIN.replace("(and (asked ?i)", "(and (asked ?i) (stored ?i store)").replace(
        "(:predicates", "(:constants store - place) (:predicates"
    )
    everybody_problem = two.replace("lab store attic", "lab attic")
    for domain, problem in ((DOMAIN, two), (everybody, everybody_problem)):
        team = TeamProblem(parse_problem(problem, parse_domain(domain)))
        requests = Outlook(team, build_stage(team.robot)).requests
        assert len(requests) == 4
        by_nurse, by_doctor = requests["ask", "nurse", "plaster"], requests["ask", "doctor", "plaster"]
        assert by_nurse.fulfilled_by == by_doctor.fulfilled_by
        assert ("fetch", "robo", "plaster", "store") in by_nurse.fulfilled_by


@pytest.mark.parametrize("most", [100_000, 3])
def test_what_is_remembered_is_what_a_fresh_search_finds(monkeypatch, most):
    monkeypatch.setattr("explicable.execution.remembering.MOST_REMEMBERED", most)
    for problem in (hospital(), encode(generate(np.random.default_rng(5), height=4, width=4), "exclusive")):
        outlook = prepare(problem).belief
        task, rng, state = outlook.task, np.random.default_rng(0), outlook.task.initial_state
        for _ in range(40):
            start = task.successor(state, outlook.stage.settle)
            fresh = search(task, "astar", initial_state=start)
            assert outlook.mission_cost(state) == (math.inf if fresh.cost is None else fresh.cost)
            way = outlook.mission_way(state)
            assert way is None or sum(map(task.cost, way)) == fresh.cost
            operators = [o for o in task.applicable(start) if task.action(o)]
            if not operators:
                break
            # Most steps follow the way remembered, so that memory and search take turns.
            follow = way and rng.random() < 0.7
            operator = way[0] if follow else operators[rng.integers(len(operators))]
            state = task.successor(state, operator)


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
def test_a_tour_of_all_rooms_is_what_the_mission_costs_a_robot_that_searches_alone(semantics):
    for seed in range(4):
        world = generate(np.random.default_rng(seed), height=5, width=5, num_marks=4)
        outlook = prepare(encode(world, semantics)).belief
        task = outlook.task
        start = task.successor(task.initial_state, outlook.stage.settle)
        tour = _core.heuristic_value(task.core, start, list(task.goal), "tour")
        exact = search(task, "astar", initial_state=start, heuristic="lmcut").cost
        assert tour == exact == outlook.mission_cost(task.initial_state)


def test_flipping_a_belief_is_undone_by_flipping_it_back():
    stage = prepare(hospital()).belief.stage
    state = stage.task.initial_state
    for atom in stage.beliefs:
        held = stage.task.holds(atom, state)
        flipped = stage.believe(state, atom, true=not held)
        assert stage.task.holds(atom, flipped) is not held
        assert stage.believe(flipped, atom, true=held) == state
        assert stage.task.atoms(flipped) ^ stage.task.atoms(state) == {atom}

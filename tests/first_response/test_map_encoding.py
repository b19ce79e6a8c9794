"""The planning problems that maps become: what each semantics allows; shortest plans are shortest tours."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.first_response.encoding import encode
from explicable.first_response.generator import generate
from explicable.first_response.map_file import parse_map
from explicable.first_response.world import cell_at, distances
from explicable.model.grounding import ground, ground_team
from explicable.model.team import Agent
from explicable.pddl import format_domain, format_problem, parse_domain, parse_problem
from oracles.first_response import commanded_plan, worlds

WORLD = parse_map("*@x*\n....\n.o.#")
BOTH = pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
COMMAND, OTHER = ("command", "person", "c-0-0"), ("command", "person", "c-0-3")
MOVE, VISIT = ("move", "r1", "c-0-1", "c-0-0"), ("visit-room", "r1", "c-0-0")


def shortest_plan(task):
    """Breadth-first search over all states: the length of a shortest plan."""
    frontier, seen, length = [task.initial_state], {task.initial_state}, 0
    while frontier:
        if any(task.is_goal(state) for state in frontier):
            return length
        after = {task.successor(state, operator) for state in frontier for operator in task.applicable(state)}
        frontier = list(after - seen)
        seen |= after
        length += 1
    return None


def shortest_tour(world, view):
    """A shortest tour through all rooms, and a command and a visit for each."""
    table = {stop: distances(world, stop, view=view) for stop in (*world.robots, *world.marks)}
    tours = itertools.permutations(world.marks)
    return 2 * len(world.marks) + min(
        sum(table[a][b] for a, b in itertools.pairwise((world.robots[0], *tour))) for tour in tours
    )


@given(st.integers(0, 10**6), st.sampled_from(["persistent", "exclusive"]))
@settings(max_examples=25)
def test_shortest_plans_are_shortest_tours_in_truth_and_in_belief(seed, semantics):
    world = generate(np.random.default_rng(seed), height=3, width=4, num_marks=2)
    team = ground_team(encode(world, semantics))
    assert shortest_plan(team.task) == shortest_tour(world, "robot")
    assert shortest_plan(team.mental) == shortest_tour(world, "human")


@given(worlds(), st.sampled_from(["persistent", "exclusive"]))
def test_whatever_loads_can_be_planned_for(world, semantics):
    team = ground_team(encode(world, semantics))
    for task, view in ((team.task, "robot"), (team.mental, "human")):
        assert task.is_goal(task.execute(commanded_plan(world, view)).states[-1])


def legal(world, semantics, actions):
    """Whether the actions can be executed one after the other."""
    task = ground(encode(world, semantics).robot)
    state = task.initial_state
    for action in actions:
        operator = next((o for o in task.operators_of(action) if task.is_applicable(state, o)), None)
        if operator is None:
            return False
        state = task.successor(state, operator)
    return True


@pytest.mark.parametrize(
    ("actions", "persistent", "exclusive"),
    [
        ([MOVE], True, False),  # only exclusive commands tie moves
        ([COMMAND, MOVE, VISIT], True, True),
        ([MOVE, VISIT], False, False),  # a visit always needs a command
        ([OTHER, MOVE, VISIT], False, False),
        ([COMMAND, OTHER, MOVE, VISIT], True, False),  # a new command replaces the one in force
        ([COMMAND, OTHER, COMMAND, MOVE, VISIT], True, True),  # people change their mind and back
        ([COMMAND, MOVE, VISIT, COMMAND], False, False),  # what is visited is not commanded again
        ([COMMAND, MOVE, VISIT, VISIT], False, False),
        ([COMMAND, MOVE, VISIT, ("move", "r1", "c-0-0", "c-0-1")], True, False),  # a visit fulfils
        ([COMMAND, ("move", "r1", "c-0-1", "c-0-2")], False, False),  # a hidden obstacle
        ([COMMAND, ("move", "r1", "c-0-1", "c-1-1"), ("move", "r1", "c-1-1", "c-2-1")], False, False),
    ],
)
def test_what_the_two_semantics_allow(actions, persistent, exclusive):
    assert legal(WORLD, "persistent", actions) == persistent
    assert legal(WORLD, "exclusive", actions) == exclusive


def test_an_obstacle_is_removed_once_and_is_floor_then():
    down, up = ("c-1-1", "c-2-1"), ("c-2-1", "c-1-1")
    there = [("move", "r1", "c-0-1", "c-1-1"), ("remove-obstacle", "r1", *down), ("move", "r1", *up)]
    assert legal(WORLD, "persistent", [*there, ("move", "r1", *down)])
    assert not legal(WORLD, "persistent", [*there, ("remove-obstacle", "r1", *down)])


@BOTH
def test_the_person_believes_hidden_obstacles_to_be_clear_and_nothing_else(semantics):
    world = generate(np.random.default_rng(3))
    team = encode(world, semantics)
    true, believed = set(team.robot.init), set(team.mental.init)
    assert true < believed
    assert {(atom[0], cell_at(atom[1])) for atom in believed - true} == {
        ("clear", cell) for cell in world.hidden
    }
    assert team.robot.objects == team.mental.objects
    assert team.robot.domain == team.mental.domain


@BOTH
def test_a_command_asks_for_visits_to_its_room_and_nothing_else(semantics):
    world = parse_map("@*.\n.*@")
    domain = encode(world, semantics).robot.domain
    schemas = {schema.name: schema for schema in domain.actions}
    added = {effect.atom for effect in schemas["command"].effects if effect.positive if effect.atom.terms}
    asked = {
        schema.name
        for schema in domain.actions
        if schema.name != "command"
        if added & set(schema.precondition.parts)
    }
    assert asked == {"visit-room"}


@BOTH
def test_pddl_says_the_same_as_the_values(semantics):
    for problem in (encode(WORLD, semantics).robot, encode(WORLD, semantics).mental):
        domain = parse_domain(format_domain(problem.domain))
        read = parse_problem(format_problem(problem), domain)
        assert domain == problem.domain
        assert (set(read.init), read.objects, read.goal) == (set(problem.init), problem.objects, problem.goal)


def test_every_robot_acts_and_the_person_is_one():
    team = encode(parse_map("@*@\n..."))
    assert team.agents == (Agent("person", "human"), Agent("r1", "robot"), Agent("r2", "robot"))
    assert shortest_plan(ground(team.composite)) == 3


def test_unknown_semantics_are_refused():
    with pytest.raises(UsageError, match="persistent, exclusive, not 'loose'"):
        encode(WORLD, "loose")

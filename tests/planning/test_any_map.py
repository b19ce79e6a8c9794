"""Whatever map a text editor can produce: it is drawn and planned, and its plans work on the floor itself."""

import numpy as np
import pytest

from explicable.errors import MapError
from explicable.first_response import encode, generate, parse_map, render
from explicable.model.grounding import ground_team
from explicable.planning import objective, plan_classically, plan_explicably
from planning.floors import PATIENCE_S, judge_of_progress


def draw_map(rng, height, width, num_robots, num_marks):
    """Draw cells until every mark can be reached."""
    while True:
        cells = rng.choice(list("......#ox"), size=height * width)
        stops = rng.permutation(height * width)[: num_robots + num_marks]
        cells[stops] = ["@"] * num_robots + ["*"] * num_marks
        try:
            return parse_map("\n".join(map("".join, cells.reshape(height, width))))
        except MapError:
            continue


def walk(world, actions, semantics):
    """Walk a plan over the characters of the map: no PDDL, no task."""
    places = {f"r{number}": cell for number, cell in enumerate(world.robots, 1)}
    obstacles, commanded, visited = set(world.obstacles), set(), set()
    for name, who, *cells in actions:
        *start, end = (tuple(map(int, cell.split("-")[1:])) for cell in cells)
        if name == "command":
            commanded = {end} if semantics == "exclusive" else commanded | {end}
            assert end in set(world.marks) - visited
        elif name == "visit-room":
            assert places[who] == end
            assert end in commanded - visited
            visited.add(end)
        else:
            assert [places[who]] == start
            assert end in world.neighbours(start[0])
            assert world.rows[end[0]][end[1]] not in "#x"
            assert (end in obstacles) == (name == "remove-obstacle")
            obstacles.discard(end)
            places[who] = end
    assert visited == set(world.marks)


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
@pytest.mark.parametrize(
    "size",
    [(1, 2, 1, 1), (2, 1, 1, 1), (1, 5, 3, 2), (3, 4, 2, 5), (7, 5, 1, 4), (12, 20, 3, 8), (24, 32, 1, 15)],
)
def test_any_map_is_drawn_and_planned(size, semantics):
    world = draw_map(np.random.default_rng(size), *size)
    team = ground_team(encode(world, semantics))
    for found in (
        plan_classically(team, time_limit_s=PATIENCE_S),
        plan_explicably(team, judge_of_progress(), time_limit_s=PATIENCE_S, improve_s=0),
    ):
        walk(world, found.plan.actions, semantics)
        assert render(world, view="robot", plan=found.plan.actions).startswith("<svg")


@pytest.mark.parametrize("seed", [2, 3, 6, 8])
def test_the_explicable_plan_is_never_worse_than_one_made_without_regard_to_the_person(seed):
    world = generate(np.random.default_rng(seed), height=8, width=8, num_marks=5)
    team, labeller = ground_team(encode(world)), judge_of_progress()
    plain = plan_classically(team, labeller=labeller)
    first = plan_explicably(team, labeller, improve_s=0)
    enough = first.evaluations + plain.evaluations + 1  # to find both, and no time to improve them
    found = plan_explicably(team, labeller, improve_s=PATIENCE_S, max_evaluations=enough)
    assert found.objective <= objective(plain.plan, plain.labelled, found.alpha) + 1e-9

"""Small first-response maps of every kind, and the obvious way to play them."""

import itertools
import re

from hypothesis import strategies as st

from explicable.errors import MapError
from explicable.first_response.encoding import robot_name
from explicable.first_response.world import World, cell_name, distances, shortest_path


@st.composite
def worlds(draw):
    """Draw maps of few cells: also without border, one cell high, with several robots."""
    height, width = draw(st.integers(1, 5)), draw(st.integers(2, 6))
    characters = draw(st.lists(st.sampled_from("#.*ox@"), min_size=height * width, max_size=height * width))
    robot, mark = draw(st.permutations(range(height * width)))[:2]
    characters[robot], characters[mark] = "@", "*"
    rows = ["".join(characters[row * width : (row + 1) * width]) for row in range(height)]
    try:
        return World(tuple(rows), {"name": draw(st.text("ab :;é", max_size=5)).strip()})
    except MapError:
        return World(tuple(re.sub("[#x]", ".", row) for row in rows))


def commanded_plan(world, view="robot"):
    """Command each room in reading order; the nearest robot goes there by a shortest way and visits it."""
    actions = []
    places = {robot_name(index): cell for index, cell in enumerate(world.robots)}
    obstacles = set(world.obstacles)
    for room in world.marks:
        remaining = distances(world, room, view=view)
        robot = min(
            (name for name in places if places[name] in remaining), key=lambda name: remaining[places[name]]
        )
        actions.append(("command", "person", cell_name(room)))
        for here, there in itertools.pairwise(shortest_path(world, places[robot], room, view)):
            schema = "remove-obstacle" if there in obstacles else "move"
            actions.append((schema, robot, cell_name(here), cell_name(there)))
            obstacles.discard(there)
        actions.append(("visit-room", robot, cell_name(room)))
        places[robot] = room
    return actions

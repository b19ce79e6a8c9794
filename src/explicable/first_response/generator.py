"""Maps made by chance, after those of the study behind the paper."""

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING, TypeVar

from explicable.errors import MapError, UsageError
from explicable.first_response.world import (
    FLOOR,
    HIDDEN,
    MARK,
    MAX_SIDE,
    OBSTACLE,
    ROBOT,
    WALL,
    Cell,
    World,
    distances,
    shortest_path,
)

if TYPE_CHECKING:
    import numpy as np

Item = TypeVar("Item")

STUDY_AREA = 36
"""Cells within the border of a map of the study; the counts below are for such a map."""
STUDY_WALLS, STUDY_OBSTACLES, STUDY_HIDDEN = (2, 4), (1, 4), (5, 8)
MAX_CELLS = 400_000
"""Cells drawn before the counts of a map are declared impossible ..."""
MAX_ATTEMPTS = 200
"""... and maps."""
MISLEADING_SHARE = 0.4
"""Of the ways between two stops (robots, rooms), at least so many are longer in truth than they look ..."""
MISLEADING_CELLS = 4000
"""... unless no map among so many cells is like that, as in corridors: 111 maps of the study's size."""


@dataclass(frozen=True, slots=True)
class _Order:
    """What a map is to hold."""

    height: int
    width: int
    num_robots: int
    num_marks: int
    num_walls: int
    num_obstacles: int
    num_hidden: int


def generate(
    rng: "np.random.Generator",
    *,
    height: int = 6,
    width: int = 6,
    num_marks: int = 4,
    num_robots: int = 1,
    num_walls: int | None = None,
    num_obstacles: int | None = None,
    num_hidden: int | None = None,
    border: bool = True,
) -> World:
    """Make a map whose marked rooms can all be reached, though often not by the way that the person sees.

    Hidden obstacles form barriers across shortest ways of the floor plan, and pockets around marked rooms.
    Only ``rng.random()`` is drawn from, whose stream is the same in all releases of NumPy: a seed stands
    for a map.

    Parameters
    ----------
    rng
        Source of chance.
    height, width
        Cells within the border.
    num_marks, num_robots
        Marked rooms, and starts of robots.
    num_walls, num_obstacles, num_hidden
        Inner walls, breakable and hidden obstacles; drawn where not given: 2 to 4, 1 to 4 and 5 to 8 on a map
        of 6 by 6 cells, in proportion to the area on others.
    border
        Whether to put a wall around.

    Raises
    ------
    UsageError
        Sizes or counts that are not possible.

    Examples
    --------
    >>> import numpy as np
    >>> from explicable.first_response.map_file import format_map
    >>> print(format_map(generate(np.random.default_rng(1), height=3, width=5, num_marks=2)), end="")
    #######
    #.x.#*#
    #@x.*.#
    #....o#
    #######
    """
    largest = MAX_SIDE - 2 if border else MAX_SIDE
    if not (1 <= height <= largest and 1 <= width <= largest):
        raise UsageError(f"a map has 1 to {largest} rows and columns, not {height} by {width}")
    if num_marks < 1 or num_robots < 1:
        raise UsageError("a map has at least one marked room and one robot")
    counts = [
        _draw_count(rng, bounds, height * width) if asked is None else asked
        for asked, bounds in (
            (num_walls, STUDY_WALLS),
            (num_obstacles, STUDY_OBSTACLES),
            (num_hidden, STUDY_HIDDEN),
        )
    ]
    if min(counts) < 0 or num_marks + num_robots + sum(counts) > height * width:
        raise UsageError(f"{height} by {width} cells cannot hold all that was asked for")
    world = _draw_map(rng, _Order(height, width, num_robots, num_marks, *counts))
    if world is None:
        raise UsageError(
            f"found no map of {height} by {width} cells that holds these counts with all rooms in reach"
        )
    return _add_border(world) if border else world


def _draw_map(rng: "np.random.Generator", order: _Order) -> World | None:
    """Draw maps until one misleads enough, or content oneself with the last."""
    found = None
    area = order.height * order.width
    for attempt in range(min(MAX_ATTEMPTS, 1 + MAX_CELLS // area)):
        world = _attempt(rng, order)
        found = world or found
        if found and attempt * area > MISLEADING_CELLS:
            break
        if world and _share_misleading(world) >= MISLEADING_SHARE:
            break
    return found


def _share_misleading(world: World) -> float:
    stops = [*world.robots, *world.marks]
    num_longer = 0
    for index, stop in enumerate(stops[1:], 1):
        true, believed = distances(world, stop), distances(world, stop, view="human")
        num_longer += sum(true.get(other, inf) > believed.get(other, inf) for other in stops[:index])
    return num_longer / (len(stops) * (len(stops) - 1) / 2)


def _attempt(rng: "np.random.Generator", order: _Order) -> World | None:
    """Draw one map; None if the counts did not come out or walls cut a room off."""
    grid = {(row, column): FLOOR for row in range(order.height) for column in range(order.width)}
    cells = _shuffled(rng, list(grid))
    num_stops = order.num_robots + order.num_marks
    stops = cells[:num_stops]
    grid.update(dict.fromkeys(stops[: order.num_robots], ROBOT))
    grid.update(dict.fromkeys(stops[order.num_robots :], MARK))
    grid.update(dict.fromkeys(cells[num_stops : num_stops + order.num_walls], WALL))
    try:
        plan = World(_rows(grid, order))
    except MapError:
        return None
    expected = [shortest_path(plan, *ends) or () for ends in pairwise(_shuffled(rng, stops))]
    kept = _ways_kept_open(rng, grid, stops, {cell for way in expected for cell in way})
    if not kept.issuperset(stops):
        return None  # walls part the robots
    free = {cell for cell, character in grid.items() if character == FLOOR and cell not in kept}
    hidden: set[Cell] = set()
    for shape in _shapes(rng, plan, expected, free):
        new = [cell for cell in shape if cell in free and cell not in hidden]
        hidden.update(new[: order.num_hidden - len(hidden)])
        if len(hidden) == order.num_hidden:
            break
    # Breakable obstacles do not close a way, so they may stand on those kept open.
    floor = [cell for cell in cells if grid[cell] == FLOOR and cell not in hidden]
    if len(hidden) < order.num_hidden or len(floor) < order.num_obstacles:
        return None
    grid.update(dict.fromkeys(hidden, HIDDEN))
    grid.update(dict.fromkeys(floor[: order.num_obstacles], OBSTACLE))
    return World(_rows(grid, order))


def _ways_kept_open(
    rng: "np.random.Generator", grid: dict[Cell, str], stops: Sequence[Cell], expected: set[Cell]
) -> set[Cell]:
    """Choose ways, from the first stop to all others it can reach, that no hidden obstacle will close.

    They are shortest (Dijkstra 1959) for random lengths of the steps, greater on the ways that a person would
    expect.
    """
    draws = rng.random(len(grid)).tolist()
    length = {cell: 1 + draw * (9 if cell in expected else 3) for cell, draw in zip(grid, draws, strict=True)}
    before = {stops[0]: stops[0]}
    best = {stops[0]: 0.0}
    frontier = [(0.0, stops[0])]
    while frontier:
        distance, cell = heapq.heappop(frontier)
        if distance > best[cell]:
            continue
        row, column = cell
        for neighbour in ((row - 1, column), (row, column - 1), (row, column + 1), (row + 1, column)):
            if grid.get(neighbour, WALL) != WALL:
                further = distance + length[neighbour]
                if further < best.get(neighbour, inf):
                    best[neighbour] = further
                    before[neighbour] = cell
                    heapq.heappush(frontier, (further, neighbour))
    kept = {stops[0]}
    for stop in stops:
        cell = stop
        while cell in before and cell not in kept:
            kept.add(cell)
            cell = before[cell]
    return kept


def _shapes(
    rng: "np.random.Generator", plan: World, expected: Sequence[Sequence[Cell]], free: set[Cell]
) -> Iterator[Sequence[Cell]]:
    """Yield barriers across expected ways and pockets around rooms, then barriers through every free cell."""
    shapes = [tuple(plan.neighbours(room)) for room in plan.marks if rng.random() < 0.5]
    for way in expected:
        crossings = [(before, cell) for before, cell in pairwise(way) if cell in free]
        shapes += [_barrier(rng, *crossing) for crossing in _shuffled(rng, crossings)[:2]]
    yield from _shuffled(rng, shapes)
    for row, column in _shuffled(rng, sorted(free)):
        before = (row - 1, column) if rng.random() < 0.5 else (row, column - 1)
        yield _barrier(rng, before, (row, column))


def _barrier(rng: "np.random.Generator", before: Cell, centre: Cell) -> tuple[Cell, ...]:
    """Return a run of 3 to 6 cells across the step from one cell to the next, from its middle outwards."""
    down, right = centre[1] - before[1], centre[0] - before[0]
    reach = 1 + _below(rng, 2)
    offsets = sorted(range(-reach, reach + 1 + _below(rng, 2)), key=abs)
    return tuple((centre[0] + down * offset, centre[1] + right * offset) for offset in offsets)


def _draw_count(rng: "np.random.Generator", bounds: tuple[int, int], area: int) -> int:
    low, high = bounds
    return (low + _below(rng, high - low + 1)) * area // STUDY_AREA


def _below(rng: "np.random.Generator", bound: int) -> int:
    return int(rng.random() * bound)


def _shuffled(rng: "np.random.Generator", items: Sequence[Item]) -> list[Item]:
    keys = rng.random(len(items)).tolist()
    return [items[index] for index in sorted(range(len(items)), key=keys.__getitem__)]


def _rows(grid: dict[Cell, str], order: _Order) -> tuple[str, ...]:
    return tuple("".join(grid[row, column] for column in range(order.width)) for row in range(order.height))


def _add_border(world: World) -> World:
    side = WALL * (world.width + 2)
    return World((side, *(WALL + row + WALL for row in world.rows), side))

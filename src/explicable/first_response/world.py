"""First-response maps: what was before the disaster, what is there now, and where the robots stand.

One character is one cell (method page, section 5). A cell is a pair ``(row, column)``, both counted from 0 at
the top left; as an object of the planning problem its name is ``c-ROW-COLUMN``.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from explicable.errors import MapError, UsageError
from explicable.model.drawing import Drawn

Cell = tuple[int, int]
View = Literal["robot", "human"]

WALL, FLOOR, MARK, OBSTACLE, HIDDEN, ROBOT = "#.*ox@"
MAX_SIDE = 1000
"""Largest number of rows, and of columns, that a map may have."""

_CHARACTERS = frozenset(WALL + FLOOR + MARK + OBSTACLE + HIDDEN + ROBOT)
_UNKNOWN = re.compile("[^" + re.escape("".join(sorted(_CHARACTERS))) + "]")


@dataclass(frozen=True, slots=True)
class World(Drawn):
    """A floor plan as the robot knows it; hiding the hidden obstacles gives what the person believes.

    Parameters
    ----------
    rows
        The cells, one string a row, in the characters of the map format.
    metadata
        The ``; key: value`` comments of the file, in their order.

    Attributes
    ----------
    robots, marks
        Cells where robots start, and rooms that must be visited, in reading order.
    walls, obstacles, hidden
        Cells of walls, of breakable obstacles that all can see, and of obstacles that only the robot knows.

    Raises
    ------
    MapError
        Rows that are no map; ``line`` and ``column`` then count rows and cells from 1.

    Examples
    --------
    >>> world = World((".o*", "@x."))
    >>> world.robots, world.marks, sorted(world.hidden)
    (((1, 0),), ((0, 2),), [(1, 1)])
    >>> World(("@x*",))
    Traceback (most recent call last):
    explicable.errors.MapError: 1:3: the marked room c-0-2 cannot be reached by any robot
    """

    rows: tuple[str, ...]
    metadata: Mapping[str, str] = field(default_factory=dict)
    robots: tuple[Cell, ...] = field(init=False, repr=False, compare=False)
    marks: tuple[Cell, ...] = field(init=False, repr=False, compare=False)
    walls: frozenset[Cell] = field(init=False, repr=False, compare=False)
    obstacles: frozenset[Cell] = field(init=False, repr=False, compare=False)
    hidden: frozenset[Cell] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        _check_rows(self.rows)
        set_field = object.__setattr__  # the dataclass is frozen; these fields follow from the rows
        set_field(self, "robots", tuple(self._cells(ROBOT)))
        set_field(self, "marks", tuple(self._cells(MARK)))
        set_field(self, "walls", frozenset(self._cells(WALL)))
        set_field(self, "obstacles", frozenset(self._cells(OBSTACLE)))
        set_field(self, "hidden", frozenset(self._cells(HIDDEN)))
        self._check_stops()

    def __hash__(self) -> int:
        return hash(self.rows)

    @property
    def height(self) -> int:
        """Number of rows."""
        return len(self.rows)

    @property
    def width(self) -> int:
        """Number of columns."""
        return len(self.rows[0])

    def blocked(self, view: View = "robot") -> frozenset[Cell]:
        """Cells that nobody can enter: in truth (``robot``), or as the person believes (``human``)."""
        return self.walls | self.hidden if view == "robot" else self.walls

    def neighbours(self, cell: Cell) -> Iterator[Cell]:
        """Yield the cells above, left, right and below, as far as they lie on the map."""
        row, column = cell
        if row > 0:
            yield row - 1, column
        if column > 0:
            yield row, column - 1
        if column + 1 < self.width:
            yield row, column + 1
        if row + 1 < self.height:
            yield row + 1, column

    def _cells(self, character: str) -> Iterator[Cell]:
        for index, row in enumerate(self.rows):
            column = row.find(character)
            while column >= 0:
                yield index, column
                column = row.find(character, column + 1)

    def _check_stops(self) -> None:
        if not self.robots:
            raise MapError(f"the map has no robot ({ROBOT!r})")
        if not self.marks:
            raise MapError(f"the map has no marked room ({MARK!r})")
        steps = _flat_distances(self, self.robots, "robot")
        for mark in self.marks:
            if steps[_place(self, mark)] < 0:
                message = f"the marked room {cell_name(mark)} cannot be reached by any robot"
                raise MapError(message, line=mark[0] + 1, column=mark[1] + 1)


def _check_rows(rows: tuple[str, ...]) -> None:
    if not rows:
        raise MapError("the map is empty")
    if len(rows) > MAX_SIDE:
        raise MapError(f"more than {MAX_SIDE} rows", line=MAX_SIDE + 1)
    for line, row in enumerate(rows, 1):
        if len(row) > MAX_SIDE:
            raise MapError(f"more than {MAX_SIDE} cells in a row", line=line, column=MAX_SIDE + 1)
        if not row:
            raise MapError("a blank line inside the map", line=line)
        unknown = _UNKNOWN.search(row)
        if unknown:
            character = unknown.group()
            message = f"unknown character {character!a} (U+{ord(character):04X})"
            raise MapError(message, line=line, column=unknown.start() + 1)
        if len(row) != len(rows[0]):
            raise MapError(f"this row has {len(row)} cells, the first row has {len(rows[0])}", line=line)


def cell_name(cell: Cell) -> str:
    """Name a cell as an object of the planning problem.

    Examples
    --------
    >>> cell_name((3, 12))
    'c-3-12'
    """
    return f"c-{cell[0]}-{cell[1]}"


def cell_at(name: str) -> Cell:
    """Return the cell that an object's name stands for.

    Raises
    ------
    UsageError
        The name is not of the form ``c-ROW-COLUMN``.

    Examples
    --------
    >>> cell_at("c-3-12")
    (3, 12)
    """
    match = re.fullmatch(r"c-(0|[1-9][0-9]{0,3})-(0|[1-9][0-9]{0,3})", name)
    if not match:
        raise UsageError(f"not the name of a cell: {name!r}")
    return int(match[1]), int(match[2])


def distances(world: World, *sources: Cell, view: View = "robot") -> dict[Cell, int]:
    """Count the steps from the nearest source to every cell that can be reached (breadth-first search).

    Entering a breakable obstacle is one step like any other. In the robot's view hidden obstacles block the
    way, in the human's they are floor.

    Examples
    --------
    >>> world = World(("@x*", "..."))
    >>> distances(world, (0, 0))[(0, 2)], distances(world, (0, 0), view="human")[(0, 2)]
    (4, 2)
    """
    steps = _flat_distances(world, sources, view)
    stride = world.width + 1
    return {
        (place // stride - 1, place % stride - 1): count for place, count in enumerate(steps) if count >= 0
    }


def _flat_distances(world: World, sources: Iterable[Cell], view: View) -> list[int]:
    """Count steps as `distances` does, at `_place(world, cell)`; -1 is out of reach."""
    stride = world.width + 1
    blocked = (WALL + HIDDEN if view == "robot" else WALL).encode()
    # A wall before every row and a row of walls on either side keep the search on the map.
    padded = WALL * (stride + 1) + WALL.join(world.rows) + WALL * (stride + 1)
    is_open = bytearray(padded.encode().translate(bytes(byte not in blocked for byte in range(256))))
    steps = [-1] * len(padded)
    frontier = [_place(world, cell) for cell in sources]
    for place in frontier:
        steps[place] = is_open[place] = 0
    depth = 0
    while frontier:
        depth += 1
        reached = []
        for place in frontier:
            for neighbour in (place - stride, place - 1, place + 1, place + stride):
                if is_open[neighbour]:
                    is_open[neighbour] = 0
                    steps[neighbour] = depth
                    reached.append(neighbour)
        frontier = reached
    return steps


def _place(world: World, cell: Cell) -> int:
    return (cell[0] + 1) * (world.width + 1) + cell[1] + 1


def shortest_path(world: World, start: Cell, end: Cell, view: View = "robot") -> tuple[Cell, ...] | None:
    """Find a shortest path, both ends included; None where there is none.

    Among shortest paths it is the one that leaves each cell upwards if it can, else to the left, to the
    right, downwards.

    Examples
    --------
    >>> shortest_path(World(("@x*", "...")), (0, 0), (0, 2))
    ((0, 0), (1, 0), (1, 1), (1, 2), (0, 2))
    """
    remaining = distances(world, end, view=view)
    if start not in remaining:
        return None
    path = [start]
    while path[-1] != end:
        steps = remaining[path[-1]] - 1
        path.append(next(cell for cell in world.neighbours(path[-1]) if remaining.get(cell) == steps))
    return tuple(path)

"""What a plan does on a map: the ways taken, where commands are given, which rooms are visited."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from explicable.errors import PlanError, UsageError
from explicable.first_response.encoding import robot_name
from explicable.first_response.world import Cell, World, cell_at
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom


@dataclass(frozen=True, slots=True)
class Passage:
    """A robot's way from one cell to the next.

    ``step`` is the index in the plan; ``lane`` counts from 0 how often the same way was gone before in this
    direction.
    """

    step: int
    robot: str
    start: Cell
    end: Cell
    lane: int


@dataclass(frozen=True, slots=True)
class Command:
    """A command: where the robot stands when it is given, and to which room it sends."""

    step: int
    cell: Cell
    room: Cell


@dataclass(frozen=True, slots=True)
class Visit:
    """A visit to a room."""

    step: int
    room: Cell


@dataclass(frozen=True, slots=True)
class Routes:
    """A plan on a map, each part in the order of the plan."""

    passages: tuple[Passage, ...]
    commands: tuple[Command, ...]
    visits: tuple[Visit, ...]


def trace_routes(world: World, actions: Sequence[GroundAtom]) -> Routes:
    """Follow a plan over a map.

    Where there are several robots, a command counts as given to the one that later visits the room. Whether
    ways are blocked is not asked: a plan that fits only the person's idea of the map can be followed too.

    Raises
    ------
    PlanError
        A step that is none of the domain's, or that begins where its robot is not.

    Examples
    --------
    >>> world = World(("@.*",))
    >>> plan = [
    ...     ("command", "person", "c-0-2"),
    ...     ("move", "r1", "c-0-0", "c-0-1"),
    ...     ("move", "r1", "c-0-1", "c-0-2"),
    ... ]
    >>> routes = trace_routes(world, plan)
    >>> routes.commands
    (Command(step=0, cell=(0, 0), room=(0, 2)),)
    >>> [(passage.start, passage.end) for passage in routes.passages]
    [((0, 0), (0, 1)), ((0, 1), (0, 2))]
    """
    position = {robot_name(index): cell for index, cell in enumerate(world.robots)}
    first = robot_name(0)
    visitor = {action[2]: action[1] for action in actions if action[0] == "visit-room" and len(action) == 3}
    passages: list[Passage] = []
    commands: list[Command] = []
    visits: list[Visit] = []
    times_gone: Counter[tuple[Cell, Cell]] = Counter()
    for step, action in enumerate(actions):
        match action:
            case ("command", _, room):
                robot = visitor.get(room, first)
                commands.append(
                    Command(step, position.get(robot, position[first]), _room(world, room, step, action))
                )
            case ("move" | "remove-obstacle", robot, start, end) if robot in position:
                way = _cell(world, start, step, action), _cell(world, end, step, action)
                if position[robot] != way[0] or way[1] not in world.neighbours(way[0]):
                    raise _misfit(step, action, "is not a way from where the robot is to the next cell")
                passages.append(Passage(step, robot, *way, lane=times_gone[way]))
                times_gone[way] += 1
                position[robot] = way[1]
            case ("visit-room", robot, room) if robot in position:
                cell = _room(world, room, step, action)
                if position[robot] != cell:
                    raise _misfit(step, action, "visits a room that the robot is not in")
                visits.append(Visit(step, cell))
            case _:
                raise _misfit(step, action, "is not a step of this map's team")
    return Routes(tuple(passages), tuple(commands), tuple(visits))


def _cell(world: World, name: str, step: int, action: GroundAtom) -> Cell:
    try:
        cell = cell_at(name)
    except UsageError:
        raise _misfit(step, action, f"names no cell: {name!r}") from None
    if cell[0] >= world.height or cell[1] >= world.width:
        raise _misfit(step, action, f"leaves the map: {name!r}")
    return cell


def _room(world: World, name: str, step: int, action: GroundAtom) -> Cell:
    cell = _cell(world, name, step, action)
    if cell not in world.marks:
        raise _misfit(step, action, f"names no marked room: {name!r}")
    return cell


def _misfit(step: int, action: GroundAtom, reason: str) -> PlanError:
    return PlanError(f"step {step + 1} {format_action(action)} {reason}")

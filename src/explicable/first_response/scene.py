"""First-response maps in the midst of play, as the person sees them (SVG)."""

from collections.abc import Collection
from functools import lru_cache

from explicable.first_response import glyphs
from explicable.first_response.animation import Clock
from explicable.first_response.arrows import centre
from explicable.first_response.glyphs import CELL
from explicable.first_response.rendering import draw_floor_plan, frame_map, room_letters
from explicable.first_response.world import FLOOR, Cell, World, cell_at, cell_name
from explicable.model.problem import GroundAtom

GLIDE_S = 0.35
"""Seconds in which a robot glides to its new place."""


def render_scene(
    world: World,
    facts: Collection[GroundAtom],
    *,
    target: str | None = None,
    step: GroundAtom | None = None,
    announced: GroundAtom | None = None,
    title: str = "",
) -> str:
    """Draw a map as it stands now, without what is hidden from the person.

    Rooms are groups with the attribute ``data-room``, for pages in which they can be clicked.

    Parameters
    ----------
    world
        The map.
    facts
        The true atoms of the present state.
    target
        The room that was last commanded and not yet visited.
    step
        The step that was just taken: its robot glides from where it was.
    announced
        The step that a robot is about to take, drawn as a dashed arrow.
    title
        The picture's accessible name.

    Examples
    --------
    >>> picture = render_scene(World(("@.*",)), [("at", "r1", "c-0-1")], target="c-0-2")
    >>> 'data-room="c-0-2"' in picture
    True
    """
    named = {predicate: set[str]() for predicate in ("visited", "obstacle")}
    places = {}
    for predicate, *objects in facts:
        if predicate in named:
            named[predicate].add(objects[0])
        elif predicate == "at":
            places[objects[0]] = cell_at(objects[1])
    canvas = frame_map(world)
    parts = [_floor(world, frozenset(named["obstacle"]))]
    if target:
        parts.append(glyphs.command_cells([cell_at(target)]))
    letters = room_letters(len(world.marks))
    for room, letter in zip(world.marks, letters, strict=True):
        sign = _visited_badge(letter) if cell_name(room) in named["visited"] else glyphs.room_badge(letter)
        box = glyphs.path(glyphs.boxes([room]), fill="none", pointer_events="all")
        sign = glyphs.placed(sign, *centre(room), canvas.emphasis)
        parts.append(f'<g data-room="{cell_name(room)}">{box}{sign}</g>')
    for robot, place in sorted(places.items()):
        if announced and robot in announced:
            parts.append(_intention(announced))
        parts.append(_robot(robot, place, step, canvas.emphasis, is_alone=len(places) == 1))
    box = " ".join(glyphs.number(v) for v in (canvas.left, canvas.top, canvas.width, canvas.height))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" role="img">'
        f"<title>{glyphs.clean(title or 'Floor plan')}</title>{''.join(parts)}</svg>"
    )


@lru_cache(maxsize=1024)
def _floor(world: World, obstacles: frozenset[str]) -> str:
    """Draw the floor plan with the obstacles that are left."""
    gone = [cell for cell in world.obstacles if cell_name(cell) not in obstacles]
    rows = [list(row) for row in world.rows]
    for row, column in gone:
        rows[row][column] = FLOOR
    cleared = World(tuple("".join(row) for row in rows)) if gone else world
    return "".join(draw_floor_plan(cleared, "human", (), {}, Clock(0, 0)))


def _visited_badge(letter: str) -> str:
    tick = glyphs.path("M9 14l3.5 3.5 6 -7", stroke=glyphs.PAPER, stroke_width=2.4)
    return glyphs.room_badge(letter) + f'<circle cx="14" cy="14" r="9" fill="{glyphs.ROOM_INK}"/>' + tick


def _ends(step: GroundAtom) -> tuple[Cell, Cell] | None:
    """Return where a step that changes place begins and ends."""
    return (cell_at(step[2]), cell_at(step[3])) if len(step) == 4 else None


def _intention(step: GroundAtom) -> str:
    ends = _ends(step)
    if ends is None:
        row, column = cell_at(step[2])
        return glyphs.path(
            glyphs.boxes([(row, column)], 3), stroke=glyphs.shade(1), stroke_width=3, stroke_dasharray="6 4"
        )
    (row, column), (end_row, end_column) = ends
    heading = end_column - column, end_row - row
    tip = centre(ends[1])
    line = glyphs.line([centre(ends[0]), tip], glyphs.shade(1), dashed=True)
    return line + glyphs.arrow_head(tip, heading, glyphs.shade(1), 1.6)


def _robot(name: str, place: Cell, step: GroundAtom | None, scale: float, *, is_alone: bool) -> str:
    head = glyphs.robot_head(name) + ("" if is_alone else glyphs.label(0, 21, name, size=10, fill=glyphs.INK))
    ends = _ends(step) if step and name in step else None
    glide = ""
    if ends:
        right, down = (ends[0][1] - ends[1][1]) * CELL, (ends[0][0] - ends[1][0]) * CELL
        glide = (
            f'<animateTransform attributeName="transform" type="translate" from="{right} {down}" to="0 0" '
            f'dur="{GLIDE_S}s"/>'
        )
    return glyphs.placed(f"<g>{glyphs.placed(head, 0, 0, scale)}{glide}</g>", *centre(place))


def scene_key() -> tuple[tuple[str, str], ...]:
    """Return the signs of `render_scene`, each an SVG element of its own, with their meanings.

    Examples
    --------
    >>> [meaning for _, meaning in scene_key()]
    ['robot', 'room to visit', 'room commanded', 'room visited', 'wall', 'obstacle that the robot can clear']
    """
    cell, middle = [(0, 0)], (CELL / 2, CELL / 2)
    frame = glyphs.path(glyphs.boxes(cell, 0.5), stroke=glyphs.GRID_INK, stroke_width=1)
    room = glyphs.path(glyphs.boxes(cell), fill=glyphs.ROOM_FILL)
    signs = (
        (frame + glyphs.placed(glyphs.robot_head(""), *middle), "robot"),
        (room + glyphs.placed(glyphs.room_badge("A"), *middle), "room to visit"),
        (glyphs.command_cells(cell) + glyphs.placed(glyphs.room_badge("A"), *middle), "room commanded"),
        (room + glyphs.placed(_visited_badge("A"), *middle), "room visited"),
        (glyphs.path(glyphs.boxes(cell), fill=glyphs.WALL_INK), "wall"),
        (frame + glyphs.crates(cell), "obstacle that the robot can clear"),
    )
    start = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {CELL} {CELL}" width="36" height="36" '
        f'role="presentation" aria-hidden="true"><rect width="{CELL}" height="{CELL}" fill="{glyphs.PAPER}"/>'
    )
    return tuple((f"{start}{sign}</svg>", meaning) for sign, meaning in signs)

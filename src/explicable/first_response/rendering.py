"""First-response maps and plans as pictures (SVG)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from math import inf
from string import ascii_uppercase
from typing import get_args

from explicable.errors import UsageError
from explicable.first_response import glyphs
from explicable.first_response.animation import Clock
from explicable.first_response.arrows import draw_arrows
from explicable.first_response.encoding import robot_name
from explicable.first_response.glyphs import CELL
from explicable.first_response.picture_key import draw_key
from explicable.first_response.routes import Command, Routes, trace_routes
from explicable.first_response.signs import draw_command_labels, draw_robot_signs, draw_room_signs
from explicable.first_response.world import Cell, View, World
from explicable.model.drawing import Drawing, draw
from explicable.model.plan import JointPlan
from explicable.model.problem import GroundAtom

LARGE = 2500
"""Cells from which on a map is drawn without grid and hatching."""
LARGEST_PX = 1600
"""Largest width or height that a picture asks for, in pixels."""
NARROWEST_PX = 240
"""Least width of a picture with a title or a key."""


def render(
    world: World,
    view: View = "human",
    plan: JointPlan | Sequence[GroundAtom] | None = None,
    labels: Sequence[bool | None] | None = None,
    probabilities: Sequence[float] | None = None,
    title: str | None = None,
    key: bool = False,
    step_s: float = 0,
) -> Drawing:
    """Draw a map and, if given, a plan on it.

    Parameters
    ----------
    world
        The map.
    view
        ``robot`` shades hidden obstacles, ``human`` draws them as the floor that the person takes them for.
    plan
        Steps as arrows; cells where commands are given in yellow, with the number of the command and the
        letter of the room; rooms with the order of the visits. Ways gone several times lie side by side and
        keep to the right.
    labels
        For each step whether it is explicable, or None; the arrows of steps that are not are orange and
        dashed.
    probabilities
        For each step the probability that it is explicable: arrows are shaded from blue (1) to orange (0),
        and dashed below one half where ``labels`` do not say otherwise.
    title
        Heading, also the picture's accessible name.
    key
        Whether to explain the signs below the map.
    step_s
        Seconds for each step where the plan is to play itself, over and over; 0 for a still picture.

    Returns
    -------
    Drawing
        An SVG element without identifiers, to be written to a file or put into a page as it is; a notebook
        shows it.

    Raises
    ------
    PlanError
        The plan does not fit the map.
    UsageError
        An unknown view, a time that cannot be, or not one label or one probability a step.

    Examples
    --------
    >>> render(World(("@*",)), title="A < B")[:66]
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 -36 240 84" wid'
    """
    if view not in get_args(View):
        raise UsageError(f"a map is seen by {' or '.join(get_args(View))}, not by {view!r}")
    if not 0 <= step_s < inf:
        raise UsageError(f"a step cannot take {step_s} seconds")
    actions = plan.actions if isinstance(plan, JointPlan) else tuple(plan or ())
    doubted = _doubted_steps(actions, labels, probabilities)
    routes = trace_routes(world, actions)
    names = dict(zip(world.marks, room_letters(len(world.marks)), strict=True))

    canvas = frame_map(world)
    clock = Clock(len(actions), step_s)
    removed = {way.end: way.step for way in routes.passages if actions[way.step][0] == "remove-obstacle"}
    parts = draw_floor_plan(world, view, routes.commands, removed, clock)
    for robot in range(len(world.robots)):
        passages = [passage for passage in routes.passages if passage.robot == robot_name(robot)]
        parts += draw_arrows(
            passages, actions, doubted, probabilities, double=robot > 0, scale=canvas.emphasis, clock=clock
        )
    parts += draw_room_signs(routes, names, doubted, canvas.emphasis, clock)
    parts += draw_robot_signs(world, routes, canvas.emphasis, clock)
    parts += draw_command_labels(routes.commands, names, canvas.emphasis, clock)
    explained = None
    if key:
        explained = draw_key(round(max(canvas.width_px, NARROWEST_PX)), view, with_plan=bool(actions))
    description = _describe(world, view, actions, routes, names, doubted)
    return Drawing(_mount("".join(parts), canvas, title, explained, description))


@draw.register
def _draw_for_notebook(world: World) -> str:
    return render(world, "robot")


@dataclass(frozen=True, slots=True)
class Canvas:
    """The part of the plane that a map's picture shows, and how large.

    ``zoom`` is the number of drawing units to a pixel, ``emphasis`` how much larger than its cells the
    signs on a large map are.
    """

    left: float
    top: float
    width: float
    height: float
    zoom: float
    emphasis: float

    @property
    def width_px(self) -> float:
        """Width of the picture."""
        return self.width / self.zoom

    @property
    def height_px(self) -> float:
        """Height of the picture."""
        return self.height / self.zoom


@lru_cache(maxsize=256)
def frame_map(world: World) -> Canvas:
    """Frame a map; of a wall all around only a strip is shown."""
    last_row, last_column = world.height - 1, world.width - 1
    walled = min(last_row, last_column) > 1 and all(
        cell in world.walls
        for cell in (
            *product((0, last_row), range(world.width)),
            *product(range(world.height), (0, last_column)),
        )
    )
    cropped = 0.7 * CELL if walled else 0.0
    width, height = world.width * CELL - 2 * cropped, world.height * CELL - 2 * cropped
    zoom = max(1.0, max(width, height) / LARGEST_PX)
    return Canvas(cropped, cropped, width, height, zoom, emphasis=max(1.0, 0.75 * zoom))


def _mount(
    picture: str, canvas: Canvas, title: str | None, key: tuple[str, int] | None, description: str
) -> str:
    """Put a map's picture on paper, title above and key below, which have the same size with every map."""
    width, height, top = canvas.width_px, canvas.height_px, 0.0
    drawing = (
        f'<svg width="{glyphs.number(width)}" height="{glyphs.number(height)}" '
        f'viewBox="{_box(canvas.left, canvas.top, canvas.width, canvas.height)}">{picture}</svg>'
    )
    if title or key:
        width = max(width, NARROWEST_PX)
    if title:
        size = min(20, 1.5 * width / len(title))
        drawing += glyphs.label(2, -12, title, size=size, fill=glyphs.INK, weight=600, anchor="start")
        top -= 36
        height += 36
    if key:
        signs, key_height = key
        drawing += glyphs.placed(signs, 0, top + height + 14)
        height += key_height + 14
    box = _box(0, top, width, height)
    x, y, w, h = box.split()
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="{w}" height="{h}" role="img">'
        f"<title>{glyphs.clean(title or 'First-response map')}</title>"
        f"<desc>{glyphs.clean(description)}</desc>"
        f'<rect x="{x}" y="{y}" width="{w}" height="{h}" fill="{glyphs.PAPER}"/>{drawing}</svg>\n'
    )


def _box(*numbers: float) -> str:
    return " ".join(glyphs.number(value) for value in numbers)


def _doubted_steps(
    actions: Sequence[GroundAtom],
    labels: Sequence[bool | None] | None,
    probabilities: Sequence[float] | None,
) -> frozenset[int]:
    """Return the steps that are held for inexplicable."""
    for values, name in ((labels, "label"), (probabilities, "probability")):
        if values is not None and len(values) != len(actions):
            raise UsageError(f"a plan of {len(actions)} steps needs one {name} a step, not {len(values)}")
    if labels is not None:
        return frozenset(step for step, label in enumerate(labels) if label is False)
    return frozenset(step for step, probability in enumerate(probabilities or ()) if probability < 0.5)


def room_letters(count: int) -> list[str]:
    """Name rooms A, B, ..., Z, AA, AB, ...

    Examples
    --------
    >>> room_letters(3)
    ['A', 'B', 'C']
    """
    names = list(ascii_uppercase)
    length = 2
    while len(names) < count:
        names += ["".join(letters) for letters in product(ascii_uppercase, repeat=length)]
        length += 1
    return names[:count]


def draw_floor_plan(
    world: World, view: View, commands: Sequence[Command], removed: dict[Cell, int], clock: Clock
) -> list[str]:
    """Draw what the robots move on, signs and ways left out."""
    width, height = world.width * CELL, world.height * CELL
    large = world.width * world.height >= LARGE
    parts = [f'<rect width="{width}" height="{height}" fill="{glyphs.FLOOR_INK}"/>']
    if not large:
        grid = "".join(f"M0 {y}H{width}" for y in range(CELL, height, CELL))
        grid += "".join(f"M{x} 0V{height}" for x in range(CELL, width, CELL))
        parts.append(glyphs.path(grid, stroke=glyphs.GRID_INK, stroke_width=1))
    if view == "robot":
        parts.append(glyphs.hidden_obstacles(world.hidden, hatched=not large))
    parts.append(glyphs.path(glyphs.boxes(world.marks), fill=glyphs.ROOM_FILL))
    first = {command.cell: command.step for command in reversed(commands)}
    parts += [f"<g>{glyphs.command_cells([cell])}{clock.appear(step)}</g>" for cell, step in first.items()]
    parts.append(glyphs.crates(world.obstacles - removed.keys()))
    parts += [f"<g>{glyphs.crates([cell])}{clock.vanish(step)}</g>" for cell, step in removed.items()]
    parts.append(glyphs.path(glyphs.boxes(world.walls), fill=glyphs.WALL_INK))
    parts.append(
        f'<rect x="0.5" y="0.5" width="{width - 1}" height="{height - 1}" fill="none" '
        f'stroke="{glyphs.WALL_INK}" stroke-width="1"/>'
    )
    return parts


def _describe(
    world: World,
    view: View,
    actions: Sequence[GroundAtom],
    routes: Routes,
    names: dict[Cell, str],
    doubted: frozenset[int],
) -> str:
    seen = "as the robot sees it" if view == "robot" else "as the person sees it"
    text = (
        f"Floor plan of {world.height} by {world.width} cells {seen}: {len(world.marks)} marked rooms, "
        f"{len(world.obstacles)} breakable obstacles"
    )
    text += f", {len(world.hidden)} hidden obstacles." if view == "robot" else "."
    if actions:
        visited = ", ".join(names[visit.room] for visit in routes.visits)
        text += f" Plan of {len(actions)} steps; rooms are visited in the order {visited or 'none'}."
        if doubted:
            text += f" Inexplicable steps: {', '.join(str(step + 1) for step in sorted(doubted))}."
    return text

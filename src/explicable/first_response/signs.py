"""What stands on a map's picture above floor and ways: rooms, robots, and where commands are given."""

from collections import defaultdict
from collections.abc import Sequence

from explicable.first_response import glyphs
from explicable.first_response.animation import Clock
from explicable.first_response.arrows import centre
from explicable.first_response.encoding import robot_name
from explicable.first_response.routes import Command, Routes
from explicable.first_response.world import Cell, World, cell_name


def draw_room_signs(
    routes: Routes, names: dict[Cell, str], doubted: frozenset[int], scale: float, clock: Clock
) -> list[str]:
    """Draw the rooms' letters, and where they are visited the order of the visits."""
    parts = []
    for room, letter in names.items():
        caption = f"<title>room {letter}, {cell_name(room)}</title>"
        parts.append(glyphs.placed(caption + glyphs.room_badge(letter), *centre(room), scale))
    for order, visit in enumerate(routes.visits, 1):
        sign = glyphs.visit_badge(order, doubted=visit.step in doubted) + clock.appear(visit.step)
        parts.append(glyphs.placed(sign, *centre(visit.room), scale))
    return parts


def draw_robot_signs(world: World, routes: Routes, scale: float, clock: Clock) -> list[str]:
    """Draw the robots where they start; in a picture that plays itself they go their ways."""
    parts = []
    for index, start in enumerate(world.robots):
        name = robot_name(index)
        head = glyphs.robot_head(name)
        if len(world.robots) > 1:
            head += glyphs.label(0, 21, name, size=10, fill=glyphs.INK)
        head = glyphs.placed(head, 0, 0, scale)
        if clock.is_running:
            places = [start] * (clock.num_steps + 1)
            for passage in routes.passages:
                if passage.robot == name:
                    places[passage.step + 1 :] = [passage.end] * (clock.num_steps - passage.step)
            head = f"<g>{head}{clock.travel([centre(place) for place in places])}</g>"
        parts.append(glyphs.placed(head, *centre(start)))
    return parts


def draw_command_labels(
    commands: Sequence[Command], names: dict[Cell, str], scale: float, clock: Clock
) -> list[str]:
    """Write which commands are given where: one in each corner of a cell, more than four as a range."""
    given: dict[Cell, list[tuple[str, int]]] = defaultdict(list)
    for order, command in enumerate(commands, 1):
        given[command.cell].append((f"{order}{names[command.room]}", command.step))
    corners = ((-20, -11, "start"), (20, -11, "end"), (-20, 20, "start"), (20, 20, "end"))
    parts = []
    for cell, texts in given.items():
        shown = texts if len(texts) <= len(corners) else [(f"{texts[0][0]} …", texts[0][1]), texts[-1]]
        x, y = centre(cell)
        for (text, step), (right, down, anchor) in zip(shown, corners, strict=False):
            label = glyphs.command_label(
                x + right * scale, y + down * scale, text, size=11 * scale, anchor=anchor
            )
            parts.append(f"<g>{label}{clock.appear(step)}</g>" if clock.is_running else label)
    return parts

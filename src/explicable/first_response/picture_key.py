"""The key to pictures of maps and plans."""

from explicable.first_response import glyphs
from explicable.first_response.glyphs import CELL
from explicable.first_response.world import View

COLUMN, ROW = 156, 29
"""Least width of a column of the key, and height of its rows, in pixels."""
SCALE = 0.5


def key_entries(view: View = "robot") -> tuple[tuple[str, str], ...]:
    """Return the signs, each an SVG element of its own, with their meanings, for a page of pictures.

    Examples
    --------
    >>> [meaning for _, meaning in key_entries("human")][:3]
    ['robot at the start', 'marked room', 'wall']
    """
    side = 30
    start = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {CELL} {CELL}" width="{side}" height="{side}" '
        f'role="presentation"><rect width="{CELL}" height="{CELL}" fill="{glyphs.PAPER}"/>'
    )
    return tuple((f"{start}{sign}</svg>", meaning) for sign, meaning in map_signs(view) + plan_signs())


def draw_key(width: int, view: View, *, with_plan: bool) -> tuple[str, int]:
    """Draw the signs and what they mean in as many columns as fit; return the drawing and its height."""
    signs = map_signs(view) + (plan_signs() if with_plan else [])
    num_columns = max(1, width // COLUMN)
    num_rows = -(-len(signs) // num_columns)
    parts = []
    for index, (sign, meaning) in enumerate(signs):
        x, y = index // num_rows * (width // num_columns) + 3, index % num_rows * ROW + 3
        parts.append(glyphs.placed(sign, x, y, SCALE))
        parts.append(
            glyphs.label(x + 31, y + 16, meaning, size=12, fill=glyphs.INK, weight=400, anchor="start")
        )
    return "".join(parts), num_rows * ROW + 6


def map_signs(view: View) -> list[tuple[str, str]]:
    """Return the signs of the map, each drawn in the cell at the origin, with their meanings."""
    cell = [(0, 0)]
    frame = glyphs.path(glyphs.boxes(cell, 0.5), stroke=glyphs.GRID_INK, stroke_width=1)
    signs = [
        (frame + _in_middle(glyphs.robot_head()), "robot at the start"),
        (_room() + _in_middle(glyphs.room_badge("A")), "marked room"),
        (glyphs.path(glyphs.boxes(cell), fill=glyphs.WALL_INK), "wall"),
        (frame + glyphs.crates(cell), "breakable obstacle"),
    ]
    if view == "robot":
        signs.append((glyphs.hidden_obstacles(cell), "hidden obstacle"))
    return signs


def plan_signs() -> list[tuple[str, str]]:
    """Return the signs of plans, as `map_signs` does."""
    return [
        (_arrow(1, dashed=False), "explicable step"),
        (_arrow(0, dashed=True), "inexplicable step"),
        (glyphs.command_cells([(0, 0)]) + glyphs.command_label(4, 14, "2A", size=14), "2nd command, to A"),
        (_room() + _in_middle(glyphs.room_badge("A") + glyphs.visit_badge(1)), "room A, visited first"),
    ]


def _in_middle(sign: str) -> str:
    return glyphs.placed(sign, CELL / 2, CELL / 2)


def _room() -> str:
    return glyphs.path(glyphs.boxes([(0, 0)]), fill=glyphs.ROOM_FILL)


def _arrow(probability: float, *, dashed: bool) -> str:
    ends = [(0.0, CELL / 2), (float(CELL), CELL / 2)]
    colour = glyphs.shade(probability)
    line = glyphs.line(ends, colour, dashed=dashed, scale=1.4)
    return line + glyphs.arrow_head(ends[1], (1, 0), colour, 1.4)

"""The signs of which pictures of maps are made, as fragments of SVG.

They hold no identifiers, style sheets or scripts, so that any number of pictures can stand in one page. No
meaning rests on colour alone: each kind of cell has a shape of its own, inexplicable steps are dashed. Blue
and orange are those of Okabe and Ito (2008), which the colour-blind can tell apart.
"""

from collections.abc import Iterable, Sequence
from html import escape

Point = tuple[float, float]

CELL = 48
"""Side of a cell, in the unit of the drawing."""

INK, PAPER, FLOOR_INK, GRID_INK, WALL_INK = "#2b2f38", "#ffffff", "#fdfcf9", "#e4e0d6", "#656b78"
ROOM_FILL, ROOM_INK = "#d9eee6", "#00664f"
CRATE_FILL, CRATE_INK = "#ecdcbf", "#8a6a3a"
HIDDEN_FILL, HIDDEN_INK = "#d9d9dd", "#94949e"
COMMAND_FILL, COMMAND_INK = "#ffe46b", "#8f7000"
EXPLICABLE, INEXPLICABLE = (0x00, 0x72, 0xB2), (0xD5, 0x5E, 0x00)
FONT = 'font-family="system-ui, sans-serif"'


def clean(text: str) -> str:
    """Make any text safe inside SVG: escaped, and without characters that XML cannot hold.

    Examples
    --------
    >>> clean('<b> & "c"' + chr(0))
    '&lt;b&gt; &amp; &quot;c&quot;�'
    """
    return "".join(
        character
        if character in "\t\n"
        or " " <= character <= "\ud7ff"
        or "\ue000" <= character <= "\ufffd"
        or character > "\uffff"
        else "\ufffd"
        for character in escape(text)
    )


def number(value: float) -> str:
    """Write a coordinate with at most one decimal.

    Examples
    --------
    >>> number(12.0), number(3.14159)
    ('12', '3.1')
    """
    return f"{value:.1f}".removesuffix(".0")


def shade(probability: float) -> str:
    """Return the colour between orange (0) and blue (1).

    Examples
    --------
    >>> shade(0), shade(1)
    ('#d55e00', '#0072b2')
    """
    mixed = (
        round(low + probability * (high - low)) for low, high in zip(INEXPLICABLE, EXPLICABLE, strict=True)
    )
    return "#" + "".join(f"{channel:02x}" for channel in mixed)


def boxes(cells: Iterable[tuple[int, int]], inset: float = 0) -> str:
    """Return the path data of one box a cell; cells side by side are joined when there is no inset."""
    runs: list[list[int]] = []
    for row, column in sorted(cells):
        if not inset and runs and runs[-1][0] == row and runs[-1][1] + runs[-1][2] == column:
            runs[-1][2] += 1
        else:
            runs.append([row, column, 1])
    side = number(CELL - 2 * inset)
    return "".join(
        f"M{number(column * CELL + inset)} {number(row * CELL + inset)}"
        f"h{number(length * CELL - 2 * inset)}v{side}h-{number(length * CELL - 2 * inset)}z"
        for row, column, length in runs
    )


def crates(cells: Iterable[tuple[int, int]]) -> str:
    """Draw breakable obstacles: crates with a cross."""
    ordered = sorted(cells)
    cross = "".join(f"M{column * CELL + 9} {row * CELL + 9}l30 30m0 -30l-30 30" for row, column in ordered)
    return path(boxes(ordered, 7) + cross, fill=CRATE_FILL, stroke=CRATE_INK, stroke_width=2)


def hidden_obstacles(cells: Iterable[tuple[int, int]], hatched: bool = True) -> str:
    """Draw what only the robot knows of: grey, hatched cells."""
    ordered = sorted(cells)
    drawing = path(boxes(ordered), fill=HIDDEN_FILL)
    if hatched:
        lines = "".join(_hatch(column * CELL, row * CELL) for row, column in ordered)
        drawing += path(lines, stroke=HIDDEN_INK, stroke_width=1.5)
    return drawing


def command_cells(cells: Iterable[tuple[int, int]]) -> str:
    """Draw the ground of cells where commands are given: yellow, framed."""
    return path(boxes(cells, 1.5), fill=COMMAND_FILL, stroke=COMMAND_INK, stroke_width=1.5)


def _hatch(x: int, y: int) -> str:
    """Return slanting lines through the cell at (x, y); those of cells side by side meet."""
    lines = []
    for reach in range(16, 2 * CELL, 16):
        near, far = max(0, reach - CELL), min(reach, CELL)
        lines.append(f"M{x + near} {y + far}L{x + far} {y + near}")
    return "".join(lines)


def robot_head(name: str = "robot") -> str:
    """Draw a robot with its head around the origin; an empty name is not told."""
    title = f"<title>{clean(name)}</title>" if name else ""
    return (
        title + f'<path d="M0 -9v-5" stroke="{INK}" stroke-width="2"/><circle cy="-15" r="2.5" fill="{INK}"/>'
        f'<rect x="-13" y="-9" width="26" height="20" rx="5" fill="{INK}" stroke="{PAPER}" stroke-width="2"/>'
        f'<circle cx="-5" cy="0" r="3" fill="{PAPER}"/><circle cx="5" cy="0" r="3" fill="{PAPER}"/>'
        f'<path d="M-4 6h8" stroke="{PAPER}" stroke-width="1.6"/>'
    )


def room_badge(letter: str) -> str:
    """Draw the sign of a marked room around the origin."""
    badge = f'<circle r="12" fill="{PAPER}" stroke="{ROOM_INK}" stroke-width="3"/>'
    return badge + label(0, 4.6, letter, size=13 if len(letter) < 3 else 9, fill=ROOM_INK)


def visit_badge(order: int, *, doubted: bool = False) -> str:
    """Draw the order of a visit over a room's badge; a doubted one makes its ring orange and dashed."""
    drawing = f'<circle cx="14" cy="14" r="8" fill="{ROOM_INK}"/>'
    drawing += label(14, 17.8, str(order), size=11 if order < 100 else 8, fill=PAPER)
    if doubted:
        ring = f'<circle r="12" fill="none" stroke="{PAPER}" stroke-width="4"/>'
        ring += f'<circle r="12" fill="none" stroke="{shade(0)}" stroke-width="3" stroke-dasharray="5 3"/>'
        return ring + drawing
    return drawing


def placed(drawing: str, x: float, y: float, scale: float = 1) -> str:
    """Move a drawing's origin to a point, and enlarge it."""
    enlarged = f" scale({scale:.3g})" if scale != 1 else ""
    return f'<g transform="translate({number(x)} {number(y)}){enlarged}">{drawing}</g>'


def command_label(x: float, y: float, text: str, *, size: float = 11, anchor: str = "start") -> str:
    """Write which command is given here."""
    halo = f'stroke="{COMMAND_FILL}" stroke-width="{number(size / 4)}" paint-order="stroke"'
    return label(x, y, text, size=size, fill=INK, anchor=anchor, more=halo)


def line(
    points: Sequence[Point], colour: str, *, dashed: bool = False, double: bool = False, scale: float = 1
) -> str:
    """Draw one step of a robot, with a light rim that sets it off from what lies below."""
    data = "M" + "L".join(f"{number(x)} {number(y)}" for x, y in points)
    joined = {"stroke_linejoin": "round"}
    if dashed:
        ends = {"stroke_dasharray": f"{number(6 * scale)} {number(4 * scale)}"}
    else:
        ends = {"stroke_linecap": "round"}
    drawing = path(data, stroke=PAPER, stroke_width=number(6 * scale), **joined)
    drawing += path(
        data, stroke=colour, stroke_width=number((4.4 if double else 3.2) * scale), **joined, **ends
    )
    if double:
        drawing += path(data, stroke=PAPER, stroke_width=number(1.3 * scale), **joined)
    return drawing


def arrow_head(tip: Point, heading: tuple[int, int], colour: str, scale: float = 1) -> str:
    """Draw an arrow's head with its middle at a point; ``heading`` is the step in columns and in rows."""
    right, down = heading
    corners = []
    for ahead, aside in ((5, 0), (-4, -5), (-4, 5)):  # along the heading, and to its right
        x = tip[0] + scale * (right * ahead - down * aside)
        y = tip[1] + scale * (down * ahead + right * aside)
        corners.append(f"{number(x)} {number(y)}")
    data = f"M{'L'.join(corners)}z"
    return path(data, fill=colour, stroke=PAPER, stroke_width=number(scale), stroke_linejoin="round")


def label(
    x: float,
    y: float,
    text: str,
    *,
    size: float,
    fill: str,
    weight: int = 700,
    anchor: str = "middle",
    more: str = "",
) -> str:
    """Write a short text."""
    return (
        f'<text x="{number(x)}" y="{number(y)}" {FONT} font-size="{number(size)}" font-weight="{weight}" '
        f'text-anchor="{anchor}" fill="{fill}" {more}>{clean(text)}</text>'
    )


def path(data: str, *, fill: str = "none", **attributes: str | float) -> str:
    """Return a path element, or nothing where there is nothing to draw."""
    more = "".join(f' {name.replace("_", "-")}="{value}"' for name, value in attributes.items())
    return f'<path d="{data}" fill="{fill}"{more}/>' if data else ""

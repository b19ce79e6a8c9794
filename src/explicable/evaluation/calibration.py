"""A picture of a labeller's calibration."""

from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from explicable.labelling.quality import Calibration

SIDE, LEFT, TOP = 320, 62, 20
INK, FAINT, BLUE = "#222222", "#cccccc", "#1f5fa8"


def draw_calibration(calibration: "Calibration") -> str:
    """Draw observed rate against predicted probability as SVG; the area of a point is its number of steps.

    Points on the diagonal are perfect; above it, steps were explicable more often than predicted.

    Examples
    --------
    >>> from explicable.labelling.quality import label_quality
    >>> draw_calibration(label_quality([True, False], [0.9, 0.2]).calibration).count("<circle")
    2
    """
    most = max(calibration.num_steps.tolist(), default=1)
    points = [
        (predicted, observed, number)
        for predicted, observed, number in zip(
            calibration.predicted.tolist(),
            calibration.observed.tolist(),
            calibration.num_steps.tolist(),
            strict=True,
        )
    ]
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIDE + LEFT + 20}" height="{SIDE + TOP + 60}" '
        'font-family="sans-serif" font-size="13" role="img">',
        "<title>Calibration: observed rate of explicable steps by predicted probability</title>",
        '<rect width="100%" height="100%" fill="white"/>',
        f'<rect x="{LEFT}" y="{TOP}" width="{SIDE}" height="{SIDE}" fill="none" stroke="{INK}"/>',
        _line((0, 0), (1, 1), FAINT, dashed=True),
    ]
    for tick in (0, 0.2, 0.4, 0.6, 0.8, 1):
        x, y = _place(tick, tick)
        lines.append(f'<text x="{x}" y="{TOP + SIDE + 18}" text-anchor="middle" fill="{INK}">{tick:g}</text>')
        lines.append(f'<text x="{LEFT - 8}" y="{y + 4}" text-anchor="end" fill="{INK}">{tick:g}</text>')
    lines += [_line(one[:2], other[:2], BLUE) for one, other in pairwise(points)]
    for predicted, observed, number in points:
        x, y = _place(predicted, observed)
        radius = 3 + 9 * (number / most) ** 0.5
        lines.append(
            f'<circle cx="{x}" cy="{y}" r="{radius:.1f}" fill="{BLUE}" fill-opacity="0.55" stroke="{BLUE}">'
            f"<title>predicted {predicted:.2f}, observed {observed:.2f}, {number} steps</title></circle>"
        )
    middle = LEFT + SIDE / 2
    lines += [
        f'<text x="{middle}" y="{TOP + SIDE + 42}" text-anchor="middle" fill="{INK}">'
        "predicted probability of explicable</text>",
        f'<text transform="translate(18 {TOP + SIDE / 2}) rotate(-90)" text-anchor="middle" fill="{INK}">'
        "observed rate</text>",
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def _place(x: float, y: float) -> tuple[float, float]:
    return round(LEFT + SIDE * x, 1), round(TOP + SIDE * (1 - y), 1)


def _line(start: tuple[float, float], end: tuple[float, float], colour: str, *, dashed: bool = False) -> str:
    (x1, y1), (x2, y2) = _place(*start), _place(*end)
    dashes = ' stroke-dasharray="5 5"' if dashed else ""
    return f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{colour}" stroke-width="1.5"{dashes}/>'

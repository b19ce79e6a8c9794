"""The ways of robots as arrows: in lanes, each step joined to the one before it."""

from collections.abc import Sequence

from explicable.first_response import glyphs
from explicable.first_response.animation import Clock
from explicable.first_response.glyphs import CELL
from explicable.first_response.routes import Passage
from explicable.first_response.world import Cell
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom

LANE, NEXT_LANE, NUM_LANES = 4, 8, 3
"""A way lies so far to the right of the middle, each time it is gone again so much more, but for the last."""


def draw_arrows(
    passages: Sequence[Passage],
    actions: Sequence[GroundAtom],
    doubted: frozenset[int],
    probabilities: Sequence[float] | None,
    *,
    double: bool,
    scale: float,
    clock: Clock,
) -> list[str]:
    """Draw one robot's way.

    Parameters
    ----------
    passages, actions
        The robot's passages; all steps of the plan.
    doubted, probabilities
        Steps to be dashed; for each step the probability that it is explicable, which shades it.
    double
        Whether to draw a double line, to tell robots apart.
    scale
        How much larger than usual to draw.
    clock
        When the steps appear.
    """
    parts = []
    begin: list[glyphs.Point] = []
    heads_apart = 1 if scale == 1 else round(2 * scale)
    for index, passage in enumerate(passages):
        step = passage.step
        probability = float(step not in doubted) if probabilities is None else probabilities[step]
        colour = glyphs.shade(min(1.0, max(0.0, probability)))
        caption = f"{step + 1}. {format_action(actions[step])}"
        if probabilities is not None:
            caption += f", explicable with probability {probability:.2f}"
        elif step in doubted:
            caption += ", inexplicable"
        start = begin or [_aside(centre(passage.start), passage)]
        end, begin = _join(passage, passages[index + 1] if index + 1 < len(passages) else None)
        drawing = glyphs.line([*start, end], colour, dashed=step in doubted, double=double, scale=scale)
        if index % heads_apart == 0:
            x, y = centre(passage.start)
            right, down = _heading(passage)
            border = x + right * CELL / 2, y + down * CELL / 2
            drawing += glyphs.arrow_head(_aside(border, passage), (right, down), colour, scale)
        parts.append(f"<g><title>{glyphs.clean(caption)}</title>{drawing}{clock.appear(step)}</g>")
    return parts


def _join(passage: Passage, following: Passage | None) -> tuple[glyphs.Point, list[glyphs.Point]]:
    """Return where a step's line ends, and the points with which the next one begins."""
    middle = centre(passage.end)
    end = _aside(middle, passage)
    if following is None:
        return end, []
    right, down = _heading(passage)
    next_right, next_down = _heading(following)
    if (next_right, next_down) == (-right, -down):  # turning back: a small loop behind the middle
        end = end[0] + right * 4, end[1] + down * 4
        beside = _aside(middle, following)
        return end, [end, (beside[0] + right * 4, beside[1] + down * 4)]
    if (next_right, next_down) == (right, down):
        if _offset(passage) == _offset(following):
            return end, [end]
        beside = _aside(middle, following)
        return end, [end, (beside[0] + right * 9, beside[1] + down * 9)]
    corner = _aside(end, following)
    return corner, [corner]


def centre(cell: Cell) -> glyphs.Point:
    """Return the middle of a cell in the drawing."""
    return cell[1] * CELL + CELL / 2, cell[0] * CELL + CELL / 2


def _heading(passage: Passage) -> tuple[int, int]:
    return passage.end[1] - passage.start[1], passage.end[0] - passage.start[0]


def _offset(passage: Passage) -> int:
    return LANE + NEXT_LANE * min(passage.lane, NUM_LANES - 1)


def _aside(point: glyphs.Point, passage: Passage) -> glyphs.Point:
    """Move a point to the right of where the step leads."""
    right, down = _heading(passage)
    return point[0] - down * _offset(passage), point[1] + right * _offset(passage)

"""A schedule as a picture: one row an agent, one bar a step, in SVG."""

import math
from collections.abc import Sequence

from explicable.first_response.glyphs import COMMAND_FILL, COMMAND_INK, FONT, INK, clean, number, shade
from explicable.model.plan import format_action
from explicable.model.schedule import Schedule, ScheduledStep

_MARGIN, _LABELS, _GAP = 14.0, 90.0, 16.0
_LINE, _MOST_LINES, _PADDING = 12.0, 4, 4.0
_WIDTH, _MOST_WIDTH = 900.0, 2700.0
"""The picture grows from one to the other, as far as the bars' texts need it."""
_LETTER, _NAME_LETTER = 7.4, 8.0
"""Width of a letter of the bars' texts and of the agents' names, roughly; what is wider still is cut off."""
_CALM = "#dfe3ea"
_LINK = "#8a909c"

_Box = tuple[float, float, float, float]
"""Left, top, width and height of a bar."""


def draw_schedule(
    schedule: Schedule,
    *,
    people: Sequence[str] = (),
    probabilities: Sequence[float | None] | None = None,
    title: str | None = None,
) -> str:
    """Draw a schedule as a Gantt chart.

    A bar names its step by schema and arguments; the agent is the row's. Steps on the critical path have a
    heavy frame. Robots' steps are blue where they are probably explicable, orange and dashed where they are
    probably not, and grey without labels. People's steps are yellow. What is told stands with the robot that
    tells and with all who listen.

    Parameters
    ----------
    people
        Names of the agents who are people.
    probabilities
        Of each step of the schedule, that it is explicable; None where that is not asked.
    title
        Written above.

    Returns
    -------
    str
        An SVG document.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground
    >>> from explicable.model.schedule import make_schedule
    >>> team = encode(World(("@.*",)))
    >>> draw_schedule(make_schedule(team, ground(team.composite), [("move", "r1", "c-0-0", "c-0-1")]))[:4]
    '<svg'
    """
    top = _MARGIN + (26.0 if title else 0.0)
    bar = 6.0 + _LINE * max((len(_texts(step)) for step in schedule.steps), default=2)
    height = top + (bar + _GAP) * len(schedule.agents) + 44.0
    left = _MARGIN + _LABELS
    width = min(max(_WIDTH, left + schedule.makespan * _wanted_scale(schedule) + _MARGIN), _MOST_WIDTH)
    scale = (width - left - _MARGIN) / max(schedule.makespan, 1e-9)
    rows = {agent: top + _GAP / 2 + (bar + _GAP) * row for row, agent in enumerate(schedule.agents)}
    boxes = [
        (left + step.start * scale, rows[step.step.agent], step.duration * scale, bar)
        for step in schedule.steps
    ]
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {number(width)} {number(height)}"'
        f' width="{number(width)}" height="{number(height)}" {FONT} font-size="12" fill="{INK}" role="img">',
        f"<title>{clean(title or 'schedule')}</title>",
        '<rect width="100%" height="100%" fill="#ffffff"/>',
    ]
    if title:
        parts.append(f'<text x="{number(_MARGIN)}" y="26" font-size="15">{clean(title)}</text>')
    parts += _axis(schedule.makespan, left, top, height, scale)
    for agent, y in rows.items():
        text_y = number(y + bar / 2 + 4)
        name = _fit(agent, int(_LABELS / _NAME_LETTER))
        parts.append(
            f"<g><title>{clean(agent)}</title>"
            f'<text x="{number(_MARGIN)}" y="{text_y}" font-size="13">{clean(name)}</text></g>'
        )
    parts += _links(schedule, boxes)
    critical = set(schedule.critical_path)
    for place, (step, box) in enumerate(zip(schedule.steps, boxes, strict=True)):
        is_person = step.step.agent in people
        probability = None if probabilities is None or is_person else probabilities[place]
        for name in (step.step.agent, *step.listeners):
            at = (box[0], rows[name], *box[2:])
            parts += _bar(step, at, is_person, probability, is_critical=place in critical)
    parts.append("</svg>")
    return "\n".join(parts) + "\n"


def _axis(makespan: float, left: float, top: float, height: float, scale: float) -> list[str]:
    parts = []
    bottom = height - 30.0
    step = _tick(makespan)
    for tick in range(int(makespan / step + 1e-9) + 1):
        x = number(left + tick * step * scale)
        parts.append(
            f'<line x1="{x}" y1="{number(top)}" x2="{x}" y2="{number(bottom)}" stroke="#e4e0d6"/>'
            f'<text x="{x}" y="{number(bottom + 18)}" text-anchor="middle" fill="{_LINK}">'
            f"{tick * step:g}</text>"
        )
    return parts


def _tick(makespan: float) -> float:
    """Return a round distance between ticks, so that there are at most 16 intervals."""
    size = 10.0 ** math.floor(math.log10(max(makespan, 1e-6) / 16))
    return next(size * factor for factor in (1, 2, 5, 10) if makespan / (size * factor) <= 16)


def _links(schedule: Schedule, boxes: Sequence[_Box]) -> list[str]:
    """Draw who waits for whom, between agents."""
    parts = []
    for step, (x, y, _, height) in zip(schedule.steps, boxes, strict=True):
        for before in step.after:
            if schedule.steps[before].step.agent != step.step.agent:
                from_x, from_y, width, _ = boxes[before]
                start = f"{number(from_x + width)} {number(from_y + height / 2)}"
                end = f"{number(x)} {number(y + height / 2)}"
                parts.append(f'<path d="M {start} L {end}" fill="none" stroke="{_LINK}"/>')
    return parts


def _bar(
    step: ScheduledStep,
    box: _Box,
    is_person: bool,
    probability: float | None,
    *,
    is_critical: bool,
) -> list[str]:
    x, y, width, height = box
    action = format_action(step.step.action)
    fill = COMMAND_FILL if is_person else _CALM if probability is None else shade(probability)
    ink = "#ffffff" if probability is not None else COMMAND_INK if is_person else INK
    dashes = ' stroke-dasharray="5 3"' if probability is not None and probability < 0.5 else ""
    frame = f'stroke="{INK}" stroke-width="{2.5 if is_critical else 0.8}"'
    says = f"{step.start:g} to {step.end:g}: {action}"
    lines = _lines(step, width)
    first = (height - _LINE * len(lines)) / 2 + 9.5
    if probability is not None:
        says += f", explicable with probability {probability:.2f}"
    return [
        f'<g><title>{clean(says)}</title><rect x="{number(x + 1)}" y="{number(y)}"'
        f' width="{number(max(width - 2, 1))}" height="{number(height)}" rx="4" fill="{fill}"'
        f" {frame}{dashes}/>",
        f'<svg x="{number(x + 2)}" y="{number(y)}" width="{number(max(width - 4, 1))}"'
        f' height="{number(height)}">',
        *(
            f'<text x="50%" y="{number(first + _LINE * line)}" font-size="10.5"'
            f' text-anchor="middle" fill="{ink}">{clean(text)}</text>'
            for line, text in enumerate(lines)
        ),
        "</svg></g>",
    ]


def _lines(step: ScheduledStep, width: float) -> list[str]:
    """Return the texts of a bar, as far as there is room."""
    room = int((width - _PADDING) / _LETTER + 1e-6)
    return [_fit(text, room) for text in _texts(step) if room > 3]


def _wanted_scale(schedule: Schedule) -> float:
    """Return how wide a unit of time has to be for all names to have room; what is told is a sentence."""
    steps = [step for step in schedule.steps if not step.listeners]
    widths = [max(map(len, _texts(step))) * _LETTER + _PADDING for step in steps]
    return max((width / step.duration for width, step in zip(widths, steps, strict=True)), default=0.0)


def _texts(step: ScheduledStep) -> list[str]:
    """Return the schema and, one a line, the arguments besides the agent; or what is told, on one line."""
    schema, *arguments = step.step.action
    if arguments[:1] == [step.step.agent]:
        arguments = arguments[1:]
    num_whole = 0 if step.listeners else _MOST_LINES - 2
    rest = " ".join(arguments[num_whole:])
    return [schema, *arguments[:num_whole], *([rest] if rest else [])]


def _fit(text: str, room: int) -> str:
    """Shorten a text to so many letters."""
    return text if len(text) <= room else text[: room - 1] + "…"

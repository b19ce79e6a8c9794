"""Joint plans: steps that each belong to one agent, and the planning competition's plan format."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from explicable.errors import PlanError
from explicable.model.files import read_text
from explicable.model.problem import GroundAtom

_LINE = re.compile(r"\(([^()]+)\)")
_NAME = re.compile(r"[^\s();\"]+")

Actions = tuple[GroundAtom, ...]
"""A plan without its agents."""


@dataclass(frozen=True, slots=True)
class Step:
    """One action, executed by one agent.

    Examples
    --------
    >>> print(Step("r1", ("move", "r1", "kitchen", "hall")))
    (move r1 kitchen hall)
    """

    agent: str
    action: GroundAtom

    def __str__(self) -> str:
        return format_action(self.action)


@dataclass(frozen=True, slots=True)
class JointPlan:
    """Steps in the order of execution, and what they cost together."""

    steps: tuple[Step, ...]
    cost: int

    @property
    def actions(self) -> tuple[GroundAtom, ...]:
        """The steps without their agents."""
        return tuple(step.action for step in self.steps)

    def __len__(self) -> int:
        return len(self.steps)


def format_action(action: GroundAtom) -> str:
    """Write an action as PDDL does.

    Examples
    --------
    >>> format_action(("visit-room", "r1", "kitchen"))
    '(visit-room r1 kitchen)'
    """
    return f"({' '.join(action)})"


def parse_action(text: str, path: str | Path | None = None, line: int | None = None) -> GroundAtom:
    """Read ``(schema object ...)``, in any letter case.

    Raises
    ------
    PlanError
        If the text is not one action in parentheses.

    Examples
    --------
    >>> parse_action("(Move r1 Kitchen hall)")
    ('move', 'r1', 'kitchen', 'hall')
    """
    match = _LINE.fullmatch(text.strip())
    names = tuple(match.group(1).lower().split()) if match else ()
    if not names or not all(_NAME.fullmatch(name) for name in names):
        raise PlanError(
            f"expected one step such as (move r1 a b), found {text.strip()[:60]!r}", path=path, line=line
        )
    return names


def parse_plan(text: str, path: str | Path | None = None) -> tuple[GroundAtom, ...]:
    r"""Read a plan: one ``(action object ...)`` a line, ``;`` begins a comment, blank lines are skipped.

    Raises
    ------
    PlanError
        With the line, if it holds anything else.

    Examples
    --------
    >>> parse_plan("(move r1 a b)\n; cost = 1 (unit cost)\n")
    (('move', 'r1', 'a', 'b'),)
    """
    return tuple(parse_action(line, path, number) for number, line in _step_lines(text))


def find_step(path: str | Path, step: int, *, without: str | None = None) -> int | None:
    """Give the line of a plan file, from 1, in which a step stands, from 1; None if there is no such step.

    Steps of the action schema ``without`` are not counted.
    """
    text = Path(path).read_text(encoding="utf-8-sig")
    lines = [number for number, line in _step_lines(text) if parse_action(line)[0] != without]
    return lines[step - 1] if 1 <= step <= len(lines) else None


def _step_lines(text: str) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(text.splitlines(), start=1):
        step = line.split(";", 1)[0]
        if step.strip():
            yield number, step


def read_plan(path: str | Path) -> tuple[GroundAtom, ...]:
    """Read a plan file; see `parse_plan`."""
    return parse_plan(read_text(path, PlanError), path)


def format_plan(actions: Sequence[GroundAtom] | Iterable[GroundAtom], cost: int) -> str:
    """Write a plan in the competition's format, its cost in the last line.

    Examples
    --------
    >>> print(format_plan([("move", "r1", "a", "b")], 1), end="")
    (move r1 a b)
    ; cost = 1
    """
    return "".join(f"{format_action(action)}\n" for action in actions) + f"; cost = {cost}\n"

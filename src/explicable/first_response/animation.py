"""Plans that play themselves: pictures that move without a script (SMIL, part of SVG)."""

from collections.abc import Sequence
from dataclasses import dataclass

from explicable.first_response.glyphs import Point, number

FAINT = 0.12
"""Opacity of what has not happened yet."""
PAUSE = 4
"""Steps' worth of rest after the last step, before the plan begins anew."""


@dataclass(frozen=True, slots=True)
class Clock:
    """When each step of a plan takes place; all is drawn at once where a step takes no time.

    Parameters
    ----------
    num_steps
        Length of the plan.
    step_s
        Seconds for each step; 0 for a picture that stands still.

    Examples
    --------
    >>> Clock(num_steps=4, step_s=0.5).appear(2)[:67]
    '<animate attributeName="opacity" values="0.12;1" keyTimes="0;0.25" '
    >>> Clock(num_steps=4, step_s=0).appear(2)
    ''
    """

    num_steps: int
    step_s: float

    @property
    def is_running(self) -> bool:
        """Whether anything moves."""
        return self.step_s > 0

    def appear(self, step: int) -> str:
        """Let the element around stand out once a step begins."""
        return self._switch(f"{FAINT};1", step)

    def vanish(self, step: int) -> str:
        """Let the element around fade once a step is done."""
        return self._switch(f"1;{FAINT}", step + 1)

    def travel(self, places: Sequence[Point]) -> str:
        """Move the element around from place to place: where it is before each step and after the last."""
        if not self.is_running:
            return ""
        start = places[0]
        moves = [f"{number(x - start[0])} {number(y - start[1])}" for x, y in (*places, places[-1])]
        times = [*(self._share(step) for step in range(len(places))), "1"]
        return (
            f'<animateTransform attributeName="transform" type="translate" values="{";".join(moves)}" '
            f'keyTimes="{";".join(times)}" {self._course()}/>'
        )

    def _switch(self, values: str, step: int) -> str:
        if not self.is_running:
            return ""
        return (
            f'<animate attributeName="opacity" values="{values}" keyTimes="0;{self._share(step)}" '
            f'calcMode="discrete" {self._course()}/>'
        )

    def _share(self, step: int) -> str:
        return f"{step / (self.num_steps + PAUSE):.6f}".rstrip("0").rstrip(".")

    def _course(self) -> str:
        return f'dur="{(self.num_steps + PAUSE) * self.step_s:g}s" repeatCount="indefinite"'

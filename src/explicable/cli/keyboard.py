"""A person at the keyboard: sees a map, commands, says what makes sense; on a terminal or through a pipe."""

import sys
from collections.abc import Callable
from string import ascii_uppercase
from typing import TYPE_CHECKING

from explicable.errors import visible
from explicable.execution.people import Watcher

if TYPE_CHECKING:
    from explicable.execution import Course, Setting
    from explicable.first_response import World
    from explicable.model.problem import GroundAtom
    from explicable.model.requests import Request
    from explicable.model.task import State

_YES, _NO = ("y", "yes"), ("n", "no")


class Keyboard:
    """Shows a map as the person sees it, and reads lines.

    Parameters
    ----------
    world
        The map.

    Attributes
    ----------
    rooms
        The marked rooms by their letters.
    """

    def __init__(self, world: "World") -> None:
        from rich.console import Console

        from explicable.first_response.world import cell_name

        self.world = world
        cells = [cell_name(mark) for mark in world.marks]
        self.rooms = dict(zip(_letters(len(cells)), cells, strict=True))
        self._lines = sys.stdin
        self._console = Console(highlight=False, soft_wrap=True)

    def show(self, atoms: "frozenset[GroundAtom]") -> None:
        """Draw the floor plan from before the disaster, the robot and the rooms not yet visited in it."""
        from rich.text import Text

        from explicable.first_response.world import FLOOR, HIDDEN, OBSTACLE, cell_name

        letters = {cell: letter for letter, cell in self.rooms.items() if ("visited", cell) not in atoms}
        robots = {atom[2] for atom in atoms if atom[0] == "at"}
        picture = Text()
        for row, line in enumerate(self.world.rows):
            for column, character in enumerate(line):
                name = cell_name((row, column))
                seen, style = (FLOOR if character not in "#o" else character), "dim"
                if character == HIDDEN or (character == OBSTACLE and ("obstacle", name) not in atoms):
                    seen = FLOOR
                if name in letters:
                    seen, style = letters[name], "bold yellow"
                if name in robots:
                    seen, style = "@", "bold green"
                picture.append(seen, style=style)
            picture.append("\n")
        self._console.print(picture, end="")

    def ask(self, question: str) -> str | None:
        """Return the answer without blanks around it; None at the end of input."""
        self._console.print(visible(question), end=" ", markup=False)
        line = self._lines.readline()
        return line.strip() if line else None

    def tell(self, text: str) -> None:
        """Print a line."""
        self._console.print(visible(text), markup=False)


class KeyboardPerson(Watcher):
    """Commands by the rooms' letters, and answers yes or no; a letter instead of an answer is a new command.

    Parameters
    ----------
    name
        In the record.
    setting
        Where the game is played.
    keyboard
        Where it is shown.
    ask
        Whether to ask about each robot step.
    pause
        Called before a robot's step is shown.

    Attributes
    ----------
    quit
        Called at the end of input.
    """

    def __init__(
        self, name: str, setting: "Setting", keyboard: Keyboard, *, ask: bool, pause: Callable[[], None]
    ) -> None:
        super().__init__(name, setting)
        self.origin = "person"
        self.quit: Callable[[], None] = lambda: None
        self._keyboard, self._asks, self._pause = keyboard, ask, pause
        self._wish: GroundAtom | None = None
        self._has_left = False

    def thinks_over(self) -> bool:
        """Tell whether a command was given in the place of an answer."""
        return self._wish is not None

    def choose(self, refused: "frozenset[GroundAtom]") -> "GroundAtom | None":
        """Ask for a command; an empty line lets the robot go on."""
        wish, self._wish = self._wish, None
        if wish is not None and wish not in refused:
            return wish
        if wish is not None:
            self._keyboard.tell("that can't be done")
        if self._has_left:
            return None
        return self._read("Which room next? (a letter; Enter: let the robot go on)")

    def judge(self, action: "GroundAtom", state: "State") -> bool | None:
        """Ask whether a step made sense."""
        self._pause()
        if not self._asks or self._has_left:
            return None
        after = self.setting.truth.follow(state, [action])
        if after is not None:
            self._keyboard.show(self.setting.truth.task.atoms(after))
        answer = self._answer(f"{' '.join(action)}: does this make sense? (y, n, or a room's letter)")
        if answer in _YES + _NO:
            return answer in _YES
        self._wish = self._command(answer)
        return None

    def look(self, course: "Course") -> None:
        """Show where the game stands, when it begins."""
        if len(course.occurrences) == 1:
            self._keyboard.show(course.truth.task.atoms(course.state))

    def give_up(self, request: "Request") -> None:
        """Say that a request can't be fulfilled."""
        super().give_up(request)
        self._keyboard.tell(f"the robot sees no way to do what you asked for: {' '.join(request.action)}")

    def _read(self, question: str) -> "GroundAtom | None":
        while answer := self._answer(question):
            command = self._command(answer)
            if command is not None:
                return command
            self._keyboard.tell(f"no such room; there are {', '.join(self._keyboard.rooms)}")
        return None

    def _answer(self, question: str) -> str:
        answer = self._keyboard.ask(question)
        if answer is None:
            self._has_left = True
            self.quit()
        return (answer or "").lower()

    def _command(self, answer: str) -> "GroundAtom | None":
        cell = self._keyboard.rooms.get(answer.upper())
        person = next(agent.name for agent in self.setting.problem.agents if agent.kind == "human")
        return None if cell is None else ("command", person, cell)


def _letters(number: int) -> list[str]:
    """Return A, B, ..., Z, A2, B2, ... without Y and N, which are answers."""
    letters = [letter for letter in ascii_uppercase if letter not in "YN"]
    return [
        letters[i % len(letters)] + (str(i // len(letters) + 1) if i >= len(letters) else "")
        for i in range(number)
    ]

"""Every exception that the package raises, in one tree.

::

    ExplicableError
    ├── UsageError (also a ValueError)    the caller handed in something that cannot be meant
    ├── InputError                        foreign data is wrong; says file, line and column or record
    │   ├── PDDLError                     a domain or problem file
    │   │   ├── UnsupportedFeatureError   well-formed PDDL that this package does not plan for
    │   │   └── ConflictError             the robot's and the human's model can't be composed
    │   ├── PlanError                     a plan file, or a plan that its task refuses
    │   ├── MapError                      a first-response map
    │   ├── TraceError                    a file of labelled traces
    │   ├── EpisodeError                  a game on record
    │   ├── LabellerError                 a labeller file
    │   └── RobotError                    a message on a robot's wire
    └── ResourceError                     a task needs more memory than was allowed

*Unsolvable*, *out of time* and *the person deviated* are results, not exceptions.
"""

from collections.abc import Sequence
from pathlib import Path


def visible(text: str, *, besides: str = "") -> str:
    r"""Write characters that can't be printed as `repr` does: they might speak to the reader's terminal.

    Parameters
    ----------
    besides
        Characters that stay as they are.

    Examples
    --------
    >>> print(visible("\x1b[2Jall is w\u202eell"))
    \x1b[2Jall is w\u202eell
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in besides else repr(c)[1:-1] for c in text)


class ExplicableError(Exception):
    """Base of every error that this package raises on purpose."""


class UsageError(ExplicableError, ValueError):
    """The caller handed in a value that cannot be meant."""


class ResourceError(ExplicableError):
    """A task needs more memory than the machine or the caller allows."""


class InputError(ExplicableError):
    """Data from outside is wrong.

    Parameters
    ----------
    message
        What is wrong, without the place.
    path
        File that the data came from, if any.
    line, column
        Place in the file, both counted from 1.

    Examples
    --------
    >>> str(InputError("rows differ in length", path="a.map", line=3))
    'a.map:3: rows differ in length'
    """

    def __init__(
        self,
        message: str,
        *,
        path: str | Path | None = None,
        line: int | None = None,
        column: int | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.path = path
        self.line = line
        self.column = column

    def __str__(self) -> str:
        place = [str(part) for part in (self.path, self.line, self.column) if part is not None]
        return f"{':'.join(place)}: {self.message}" if place else self.message


class PDDLError(InputError):
    """A domain or problem file is not what it claims to be."""


class UnsupportedFeatureError(PDDLError):
    """Well-formed PDDL that this package does not plan for."""


class ConflictError(PDDLError):
    """The robot's and the human's model use the same names for different things.

    Parameters
    ----------
    conflicts
        One error for each name, with its place in the human's file where that is known.

    Examples
    --------
    >>> str(ConflictError([PDDLError("type 'cart' ...", path="a.pddl", line=3), PDDLError("object 'x' ...")]))
    "a.pddl:3: type 'cart' ... (one of 2 conflicts: `explicable team` lists them)"
    """

    def __init__(self, conflicts: Sequence[PDDLError]) -> None:
        first = conflicts[0]
        number = len(conflicts)
        more = f" (one of {number} conflicts: `explicable team` lists them)" if number > 1 else ""
        super().__init__(first.message + more, path=first.path, line=first.line, column=first.column)
        self.conflicts = tuple(conflicts)


class PlanError(InputError):
    """A plan file is damaged, or its task refuses one of its steps.

    Parameters
    ----------
    step
        Number of the step that is refused, from 1.
    """

    def __init__(
        self,
        message: str,
        *,
        path: str | Path | None = None,
        line: int | None = None,
        column: int | None = None,
        step: int | None = None,
    ) -> None:
        super().__init__(message, path=path, line=line, column=column)
        self.step = step


class MapError(InputError):
    """A first-response map breaks the format."""


class TraceError(InputError):
    """A file of labelled traces is damaged."""


class EpisodeError(InputError):
    """A game on record is damaged."""


class LabellerError(InputError):
    """A labeller file is damaged, foreign, or does not fit the problem."""


class RobotError(InputError):
    """A message on a robot's wire is damaged or not meant for whom it reached."""

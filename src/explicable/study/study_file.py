"""Reading ``study.toml``: what is wrong with it is said with the key and its line."""

import re
import tomllib
from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from explicable.errors import InputError
from explicable.study.config import FILE, Study

_HEADER = re.compile(r"\s*\[(\[?)\s*([\w.\"'-]+)\s*\]")
_KEY = re.compile(r"\s*[\"']?([\w.-]+)[\"']?\s*=")


def read_study(folder: str | Path) -> Study:
    """Read a study's file.

    Raises
    ------
    InputError
        If it is missing or wrong; names the key and its line.

    Examples
    --------
    >>> read_study("nowhere")
    Traceback (most recent call last):
    explicable.errors.InputError: nowhere/study.toml: cannot be read: No such file or directory
    """
    path = Path(folder) / FILE
    try:
        text = path.read_text(encoding="utf-8-sig")
        data = tomllib.loads(text)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", path=path) from error
    except tomllib.TOMLDecodeError as error:
        raise _misspelt(error, path) from error
    except (ValueError, RecursionError) as error:  # no UTF-8; a number of thousands of digits; brackets
        raise InputError(f"not TOML: {error}", path=path) from error
    shared = data.get("play", {})
    conditions = data.get("condition")
    if isinstance(shared, dict) and isinstance(conditions, list):
        # A condition says only what differs from the table that all share.
        data["condition"] = [{**shared, **c} if isinstance(c, dict) else c for c in conditions]
    try:
        return Study.model_validate(data)
    except ValidationError as error:
        raise _misstated(error, text, path) from error


def _misspelt(error: tomllib.TOMLDecodeError, path: Path) -> InputError:
    """Say where a file is no TOML."""
    place = re.search(r" \(at line (\d+), column (\d+)\)$", str(error))
    if place is None:
        return InputError(f"not TOML: {error}", path=path)
    message = f"not TOML: {str(error)[: place.start()]}"
    return InputError(message, path=path, line=int(place[1]), column=int(place[2]))


def _misstated(error: ValidationError, text: str, path: Path) -> InputError:
    """Say which key of a file has no meaning, and where it stands."""
    first = error.errors()[0]
    name = ".".join(str(part + 1 if isinstance(part, int) else part) for part in first["loc"])
    told = {"extra_forbidden": "there is no such key", "missing": "is missing"}
    message = told.get(first["type"], first["msg"].removeprefix("Value error, "))
    return InputError(f"{name}: {message}" if name else message, path=path, line=line_of(text, first["loc"]))


def line_of(text: str, place: Sequence[str | int]) -> int | None:
    r"""Return the line of a key, or else of its table's header, counted from 1; None where it is not found.

    Parameters
    ----------
    text
        The file.
    place
        The key's path: names of tables and keys, and places in arrays of tables, counted from 0.

    Examples
    --------
    >>> text = 'seed = 1\n[[task]]\nname = "a"\n[[task]]\npeople = 0\n'
    >>> line_of(text, ("seed",)), line_of(text, ("task", 1, "people")), line_of(text, ("task", 0, "people"))
    (1, 5, 2)
    """
    table: tuple[str | int, ...] = ()
    numbers: dict[str, int] = {}
    found = None
    for number, line in enumerate(text.splitlines(), start=1):
        if header := _HEADER.match(line):
            is_array, name = header[1], header[2].strip("\"'")
            numbers[name] = numbers.get(name, -1) + 1
            table = (name, numbers[name]) if is_array else (name,)
            if tuple(place[: len(table)]) == table:
                found = number
        elif (key := _KEY.match(line)) and (*table, key[1]) == tuple(place[: len(table) + 1]):
            return number
    return found

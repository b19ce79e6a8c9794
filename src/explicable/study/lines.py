"""Where in a TOML file something stands, so that what is wrong with it can be found."""

import re
from collections.abc import Sequence

_HEADER = re.compile(r"\s*\[(\[?)\s*([\w.\"'-]+)\s*\]")
_KEY = re.compile(r"\s*[\"']?([\w.-]+)[\"']?\s*=")


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

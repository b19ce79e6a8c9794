"""What was found out is kept, within bounds."""

from typing import TypeVar

MOST_REMEMBERED = 100_000
"""States about which one thing is remembered: a few ten megabytes."""

Key = TypeVar("Key")
Value = TypeVar("Value")


def remember(known: dict[Key, Value], key: Key, value: Value, most: int | None = None) -> Value:
    """Note what was found out, and return it; where too much is known, all else is forgotten.

    ``most``: how much may be known, by default `MOST_REMEMBERED`.

    Examples
    --------
    >>> known = {1: "one", 2: "two"}
    >>> remember(known, 3, "three", most=2), known
    ('three', {3: 'three'})
    """
    if len(known) >= (MOST_REMEMBERED if most is None else most):
        known.clear()
    known[key] = value
    return value

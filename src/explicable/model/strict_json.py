"""JSON as its standard has it, for files and messages from outside."""

import json
from typing import Any, NoReturn


def parse_json(text: str) -> object:
    """Read JSON; Python's reader takes NaN, keys that occur twice and halves of characters as well.

    Raises
    ------
    ValueError
        If it is none: a `json.JSONDecodeError`, with the place, where the syntax is wrong.
    RecursionError
        If it is nested too deeply.

    Examples
    --------
    >>> parse_json('{"cost": NaN}')
    Traceback (most recent call last):
    ValueError: NaN is no JSON number
    """
    data: object = json.loads(text, parse_constant=_refuse_constant, object_pairs_hook=_refuse_repetition)
    json.dumps(data, ensure_ascii=False).encode()  # lone surrogates are no text
    return data


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no JSON number")


def _refuse_repetition(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) < len(pairs):
        keys = [key for key, _ in pairs]
        raise ValueError(f"the key {next(key for key in keys if keys.count(key) > 1)!r} occurs twice")
    return data

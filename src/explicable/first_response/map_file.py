"""Map files: a world as text, one character a cell, with comments and metadata (method page, section 5)."""

import re
from pathlib import Path

from explicable.errors import MapError, UsageError
from explicable.first_response.world import World

MAX_BYTES = 8 * 1024 * 1024
"""Largest map file that is read: the largest map, and as much again and more for comments."""

_METADATA = re.compile(r";[ \t]*([A-Za-z][\w.-]*)[ \t]*:[ \t]*([^\r\n]*)")


def parse_map(text: str, path: str | Path | None = None) -> World:
    r"""Read a map from text.

    Line ends may be those of any system; a byte-order mark, blanks at line ends, and blank lines before and
    after the map are ignored. Lines that begin with ``;`` are comments wherever they stand; those of the
    form ``; key: value`` become metadata (the last one counts where a key is repeated).

    Parameters
    ----------
    text
        The file's content.
    path
        Where it came from, for messages.

    Raises
    ------
    MapError
        With path, line and column of what is wrong.

    Examples
    --------
    >>> world = parse_map("; name: corridor\r\n@.x\r\n..*")
    >>> world.metadata["name"], world.height, world.width
    ('corridor', 2, 3)
    >>> parse_map("@.*\n..", path="short.map")
    Traceback (most recent call last):
    explicable.errors.MapError: short.map:2: this row has 2 cells, the first row has 3
    """
    rows: list[str] = []
    row_lines: list[int] = []
    metadata: dict[str, str] = {}
    # Not str.splitlines: it also splits at characters that no editor shows as a line end.
    for number, line in enumerate(re.split("\r\n|\n|\r", text.removeprefix("\ufeff")), 1):
        content = line.rstrip(" \t")
        if content.startswith(";"):
            entry = _METADATA.fullmatch(content)
            if entry:
                metadata[entry[1]] = entry[2]
        elif content or rows:
            rows.append(content)
            row_lines.append(number)
    while rows and not rows[-1]:
        rows.pop()
    try:
        return World(tuple(rows), metadata)
    except MapError as error:
        place = row_lines[error.line - 1] if error.line is not None else None
        raise MapError(error.message, path=path, line=place, column=error.column) from None


def read_map(path: str | Path) -> World:
    """Read a map file.

    Raises
    ------
    MapError
        The file cannot be read, is not UTF-8, or is not a map.

    Examples
    --------
    >>> read_map("nowhere.map")
    Traceback (most recent call last):
    explicable.errors.MapError: nowhere.map: cannot be read: No such file or directory
    """
    try:
        with Path(path).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise MapError(f"cannot be read: {error.strerror}", path=path) from error
    if len(content) > MAX_BYTES:
        raise MapError(f"larger than {MAX_BYTES} bytes", path=path)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = len(re.findall(b"\r\n|\n|\r", content[: error.start])) + 1
        raise MapError("not UTF-8 text", path=path, line=line) from error
    return parse_map(text, path)


def format_map(world: World) -> str:
    r"""Write a map as text: metadata first, then the rows. Other comments of a file are not kept.

    Raises
    ------
    UsageError
        Metadata that the format cannot hold: a key that is not one word, a value with a line break or with
        blanks at its ends.

    Examples
    --------
    >>> format_map(World(("@*",), {"name": "tiny"}))
    '; name: tiny\n@*\n'
    """
    lines = []
    for key, value in world.metadata.items():
        line = f"; {key}: {value}".rstrip(" \t")
        entry = _METADATA.fullmatch(line)
        if not entry or entry.groups() != (key, value):
            raise UsageError(f"a map cannot hold the metadata {key!r}: {value!r}")
        lines.append(line)
    return "\n".join([*lines, *world.rows, ""])

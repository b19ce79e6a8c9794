"""Where in a file a name is declared: looked up only when a message needs it."""

from pathlib import Path

from explicable.pddl.source import Cursor, Source

_SECTIONS = {
    "type": (":types",),
    "object": (":constants", ":objects"),
    "predicate": (":predicates",),
    "function": (":functions",),
    "action": (":action",),
}


def find_declaration(path: str | Path, kind: str, name: str) -> tuple[int, int] | None:
    """Give line and column of a declaration, both counted from 1, or None where the file has none.

    Parameters
    ----------
    path
        A PDDL file that was read without an error.
    kind
        ``"type"``, ``"object"``, ``"predicate"``, ``"function"`` or ``"action"``.
    name
        What is declared, in lower case.
    """
    source = Source(Path(path).read_bytes().decode(errors="surrogateescape"), path, None)
    for offset in source.sections():
        cursor = Cursor(source, offset)
        cursor.take()
        if cursor.take() in _SECTIONS[kind]:
            found = _find_in_section(cursor, kind, name)
            if found is not None:
                return source.position(found)
    return None


def _find_in_section(cursor: Cursor, kind: str, name: str) -> int | None:
    """Give the offset of the declared name: an action's comes first, a predicate's after a bracket."""
    depth, before = 1, ":action"
    while depth > 0 and cursor.ahead:
        token = cursor.take()
        begins = before == "(" if kind in {"predicate", "function"} else before != "-"
        if token == name and begins:
            return cursor.taken
        if kind == "action":
            return None
        depth += {"(": 1, ")": -1}.get(token, 0)
        before = token
    return None

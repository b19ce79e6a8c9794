"""Declarations: requirements, types, objects, predicates and functions."""

from collections.abc import Container, Mapping
from typing import NamedTuple

from explicable.errors import UnsupportedFeatureError
from explicable.model.problem import Function, Parameter, Predicate
from explicable.pddl.source import MAX_NESTING, Cursor, Source
from explicable.pddl.vocabulary import KEYWORDS, REQUIREMENTS, Requirements


class Typed(NamedTuple):
    """One entry of a typed list, with the place where it stands."""

    name: str
    types: tuple[str, ...]
    offset: int


def read_requirements(cursor: Cursor) -> frozenset[str]:
    """Read the rest of ``(:requirements ...)``."""
    declared = set()
    while not cursor.closes():
        if cursor.ahead not in REQUIREMENTS:
            if cursor.ahead.startswith(":"):
                raise cursor.error(f"requirement '{cursor.ahead}' is not supported", UnsupportedFeatureError)
            raise cursor.error(f"expected a requirement, not {cursor.shown}")
        declared.add(cursor.take())
    cursor.take()
    return frozenset(declared)


def read_typed_list(
    cursor: Cursor,
    what: str,
    requirements: Requirements,
    ancestors: Mapping[str, frozenset[str]] | None,
) -> list[Typed]:
    """Read ``name ... - type name ...`` and its closing bracket.

    `what` says what is listed; ``a variable`` asks for variables. Types are checked against `ancestors`,
    unless that is None.
    """
    entries: list[Typed] = []
    untyped: list[tuple[str, int]] = []
    while not cursor.closes():
        if cursor.ahead == "-":
            cursor.take()
            requirements.use(":typing", cursor.taken)
            types = _read_types(cursor, ancestors)
            entries.extend(Typed(name, types, offset) for name, offset in untyped)
            untyped.clear()
        else:
            name = cursor.take_variable() if what == "a variable" else cursor.take_name(what)
            untyped.append((name, cursor.taken))
    cursor.take()
    entries.extend(Typed(name, ("object",), offset) for name, offset in untyped)
    return entries


def _read_types(cursor: Cursor, ancestors: Mapping[str, frozenset[str]] | None) -> tuple[str, ...]:
    if cursor.ahead != "(":
        return (_read_type(cursor, ancestors),)
    cursor.take()
    if cursor.ahead != "either":
        raise cursor.error(f"expected a type or '(either ...)', not {cursor.shown}")
    cursor.take()
    types = [_read_type(cursor, ancestors)]
    while not cursor.closes():
        types.append(_read_type(cursor, ancestors))
    cursor.take()
    return tuple(types)


def _read_type(cursor: Cursor, ancestors: Mapping[str, frozenset[str]] | None) -> str:
    name = cursor.take_name("a type")
    if ancestors is not None and name not in ancestors:
        raise cursor.error_at_taken(f"undeclared type '{name}'")
    return name


def read_types(cursor: Cursor, requirements: Requirements) -> dict[str, tuple[str, ...]]:
    """Read the rest of ``(:types ...)``: each type with its parents."""
    source = cursor.source
    types: dict[str, tuple[str, ...]] = {}
    entries = read_typed_list(cursor, "a type", requirements, None)
    for name, parents, offset in entries:
        if name == "object":
            if parents != ("object",):
                raise source.error("type 'object' can't have a parent", offset)
        elif types.get(name, ("object",)) == ("object",) != parents or name not in types:
            # IPC storage lists a type under 'object' first and under its real parent later.
            types[name] = parents
        else:
            raise source.error(f"type '{name}' is declared twice", offset)
    for name, parents, offset in entries:
        for parent in parents:
            if parent not in types and parent != "object":
                raise source.error(f"undeclared type '{parent}', the parent of '{name}'", offset)
    _check_hierarchy(entries, types, source)
    return types


def _check_hierarchy(entries: list[Typed], types: Mapping[str, tuple[str, ...]], source: Source) -> None:
    """Refuse cycles, and hierarchies deeper than any real one."""
    heights = {"object": 0}  # how many types stand above one

    def measure(name: str, below: list[str], offset: int) -> int:
        if name in below:
            raise source.error(f"type '{name}' is its own ancestor", offset)
        if len(below) >= MAX_NESTING or heights.get(name, 0) >= MAX_NESTING:
            raise source.error(f"types are nested deeper than {MAX_NESTING}", offset)
        if name not in heights:
            heights[name] = 1 + max(measure(parent, [*below, name], offset) for parent in types[name])
        return heights[name]

    for name, _, offset in entries:
        measure(name, [], offset)


def name_once(
    entries: list[Typed], source: Source, what: str, taken: Mapping[str, tuple[str, ...]]
) -> dict[str, tuple[str, ...]]:
    """Make a mapping of constants or objects, refusing names that are already taken."""
    names: dict[str, tuple[str, ...]] = {}
    for name, types, offset in entries:
        if name in names or name in taken:
            where = " (it is a constant of the domain)" if name in taken else ""
            raise source.error(f"{what} '{name}' is declared twice{where}", offset)
        names[name] = types
    return names


def read_predicates(
    cursor: Cursor, above: Mapping[str, frozenset[str]], requirements: Requirements
) -> tuple[Predicate, ...]:
    """Read the rest of ``(:predicates ...)``."""
    found: dict[str, Predicate] = {}
    while not cursor.closes():
        name, parameters = _read_signature(cursor, "predicate", found, above, requirements)
        found[name] = Predicate(name, parameters)
    cursor.take()
    return tuple(found.values())


def read_functions(
    cursor: Cursor, above: Mapping[str, frozenset[str]], requirements: Requirements
) -> tuple[Function, ...]:
    """Read the rest of ``(:functions ...)``; only numbers are known."""
    found: dict[str, Function] = {}
    while not cursor.closes():
        name, parameters = _read_signature(cursor, "function", found, above, requirements)
        found[name] = Function(name, parameters)
        if cursor.ahead == "-":
            cursor.take()
            if cursor.ahead != "number":
                raise cursor.error("functions other than numbers are not supported", UnsupportedFeatureError)
            cursor.take()
    cursor.take()
    return tuple(found.values())


def _read_signature(
    cursor: Cursor,
    what: str,
    taken: Container[str],
    above: Mapping[str, frozenset[str]],
    requirements: Requirements,
) -> tuple[str, tuple[Parameter, ...]]:
    """Read ``(name ?x ... - type ...)``."""
    cursor.take_bracket("(")
    if cursor.ahead in KEYWORDS:
        raise cursor.error(f"a {what} can't be named '{cursor.ahead}'")
    name = cursor.take_name(f"a {what}")
    if name in taken:
        raise cursor.error_at_taken(f"{what} '{name}' is declared twice")
    entries = read_typed_list(cursor, "a variable", requirements, above)
    return name, tuple(Parameter(variable, types) for variable, types, _ in entries)

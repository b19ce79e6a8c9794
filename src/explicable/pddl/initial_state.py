"""The initial state: the one part of a task that can be large."""

import re
from collections.abc import Iterable, Mapping
from operator import getitem

from explicable.errors import UnsupportedFeatureError
from explicable.model.problem import Function, GroundAtom, Predicate
from explicable.pddl.formulas import FormulaReader
from explicable.pddl.source import Cursor
from explicable.pddl.vocabulary import Requirements, Vocabulary

# A flat atom, or the value of a flat function term.
_PLAIN = re.compile(r"\s*+\((?:([^()?]*+)|\s*+=\s*+\(([^()?]*+)\)\s*+(\d{1,9}+)\s*+)\)")

# For the name and each argument of an atom, what may stand there, each name mapped to itself.
_Signature = tuple[Mapping[str, str], ...]


class _InitialState:
    """What has been read so far."""

    __slots__ = ("atoms", "denied", "values")

    def __init__(self) -> None:
        self.atoms: list[GroundAtom] = []
        self.values: dict[GroundAtom, int] = {}
        self.denied: dict[GroundAtom, int] = {}  # with the offset of each


def read_init(
    cursor: Cursor, vocabulary: Vocabulary, requirements: Requirements
) -> tuple[tuple[GroundAtom, ...], dict[GroundAtom, int]]:
    """Read the rest of ``(:init ...)``: the true atoms, each once, and the initial numbers."""
    state = _InitialState()
    reader = FormulaReader(cursor, vocabulary, requirements)
    predicates = _signatures(vocabulary, vocabulary.predicates.values())
    functions = _signatures(vocabulary, vocabulary.functions.values())
    while cursor.ahead == "(":
        cursor.seek(_read_plain(cursor, predicates, functions, state))
        if cursor.ahead == "(":
            _read_entry(cursor, reader, state)
    cursor.take_bracket(")")
    init = dict.fromkeys(state.atoms)
    for atom, offset in state.denied.items():
        if atom in init:
            message = f"({' '.join(atom)}) is both true and false in ':init'"
            raise cursor.source.error(message, offset)
    return tuple(init), state.values


def _signatures(vocabulary: Vocabulary, declared: Iterable[Predicate | Function]) -> dict[str, _Signature]:
    return {
        entry.name: ({entry.name: entry.name}, *(vocabulary.members(p.types) for p in entry.parameters))
        for entry in declared
    }


def _read_plain(
    cursor: Cursor,
    predicates: Mapping[str, _Signature],
    functions: Mapping[str, _Signature],
    state: _InitialState,
) -> int:
    """Read as many plain, well-typed entries as follow each other; give the offset of what comes next.

    Nearly all of a large task is such entries. Whatever is not is left to the careful reader, which knows
    what to say about it.
    """
    text, offset = cursor.source.text, cursor.start
    while match := _PLAIN.match(text, offset):
        flat, function, digits = match.groups()
        words = (flat or function or "").split()
        signature = (predicates if digits is None else functions).get(words[0] if words else "", ())
        if not signature or len(signature) != len(words):
            break
        try:
            # Looking a name up checks its type and gives the one copy of it that all atoms share.
            atom = tuple(map(getitem, signature, words))
        except KeyError:
            break
        if digits is None:
            state.atoms.append(atom)
        elif state.values.setdefault(atom, value := int(digits)) != value:
            break
        offset = match.end()
    return offset


def _read_entry(cursor: Cursor, reader: FormulaReader, state: _InitialState) -> None:
    """Read one entry of any kind, with care."""
    source, start = cursor.source, cursor.start
    beyond = Cursor(source, start)
    beyond.take()
    head = beyond.take()
    if head == "=" and beyond.ahead == "(":
        cursor.seek(beyond.start)
        term = reader.read_function_term({})
        key = (term.name, *term.terms)
        if state.values.setdefault(key, value := reader.read_amount()) != value:
            raise cursor.error_at_taken(f"({' '.join(key)}) has two values in ':init'")
        cursor.take_bracket(")")
    elif head == "not":
        cursor.seek(beyond.start)
        state.denied[reader.read_ground_atom()] = start
        cursor.take_bracket(")")
    elif head == "at" and beyond.ahead[:1].isdigit() and beyond.take() and beyond.ahead == "(":
        message = "timed initial literals ('at') are not supported"
        raise source.error(message, start, UnsupportedFeatureError)
    else:
        state.atoms.append(reader.read_ground_atom())

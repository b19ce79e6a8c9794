"""Conditions, ground atoms and numbers: text -> model, each name checked where it stands."""

import re
from typing import NoReturn

from explicable.errors import UnsupportedFeatureError
from explicable.model.problem import (
    TRUE,
    And,
    Atom,
    Exists,
    Forall,
    Formula,
    Function,
    FunctionTerm,
    Not,
    Or,
    Parameter,
    Predicate,
)
from explicable.pddl.declarations import read_typed_list
from explicable.pddl.source import Cursor
from explicable.pddl.vocabulary import KEYWORDS, Requirements, Vocabulary

MAX_COST = 2**31 - 1  # what the core can count with

_INTEGER = re.compile(r"(\d+)(?:\.0*)?")
_DECIMAL = re.compile(r"\d*\.\d+")
_UNSUPPORTED = {
    **dict.fromkeys(("<", ">", "<=", ">="), "numeric conditions"),
    **dict.fromkeys(
        ("increase", "decrease", "assign", "scale-up", "scale-down"),
        "numeric effects other than on 'total-cost'",
    ),
    **dict.fromkeys(("always", "always-within", "hold-after", "hold-during"), "trajectory constraints"),
    **dict.fromkeys(("sometime", "sometime-after", "sometime-before"), "trajectory constraints"),
    **dict.fromkeys(("at-most-once", "within"), "trajectory constraints"),
    **dict.fromkeys(("oneof", "unknown", "probabilistic"), "uncertain effects or facts"),
    "preference": "preferences",
}

Scope = dict[str, tuple[str, ...]]  # each variable in sight with its types


class FormulaReader:
    """Reads formulas at a cursor, with the names of one file."""

    __slots__ = ("_cursor", "_requirements", "_vocabulary")

    def __init__(self, cursor: Cursor, vocabulary: Vocabulary, requirements: Requirements) -> None:
        self._cursor = cursor
        self._vocabulary = vocabulary
        self._requirements = requirements

    def read_parameters(self) -> tuple[Parameter, ...]:
        """Read ``(?x ... - type ...)``."""
        cursor = self._cursor
        cursor.take_bracket("(")
        entries = read_typed_list(cursor, "a variable", self._requirements, self._vocabulary.ancestors)
        seen: set[str] = set()
        for name, _, offset in entries:
            if name in seen:
                raise cursor.source.error(f"parameter '{name}' is declared twice", offset)
            seen.add(name)
        return tuple(Parameter(name, types) for name, types, _ in entries)

    # Conditions

    def read_formula(self, scope: Scope) -> Formula:
        """Read one condition; ``()`` is true."""
        cursor = self._cursor
        cursor.take_bracket("(")
        start = cursor.start
        formula: Formula
        match cursor.ahead:
            case ")":
                cursor.take()
                formula = TRUE
            case "and":
                formula = And(self._read_parts(scope))
            case "or":
                self._requirements.use(":disjunctive-preconditions", start)
                formula = Or(self._read_parts(scope))
            case "imply":
                self._requirements.use(":disjunctive-preconditions", start)
                cursor.take()
                formula = Or((Not(self.read_formula(scope)), self.read_formula(scope)))
                cursor.take_bracket(")")
            case "not":
                cursor.take()
                formula = Not(self.read_formula(scope))
                if not (isinstance(formula.body, Atom) and formula.body.predicate == "="):
                    self._requirements.use(":negative-preconditions", start)
                cursor.take_bracket(")")
            case "exists":
                self._requirements.use(":existential-preconditions", start)
                formula = Exists(*self._read_quantified(scope))
            case "forall":
                self._requirements.use(":universal-preconditions", start)
                formula = Forall(*self._read_quantified(scope))
            case _:
                formula = self._read_atom(scope)
        return formula

    def _read_parts(self, scope: Scope) -> tuple[Formula, ...]:
        self._cursor.take()
        parts = []
        while not self._cursor.closes():
            parts.append(self.read_formula(scope))
        self._cursor.take()
        return tuple(parts)

    def _read_quantified(self, scope: Scope) -> tuple[tuple[Parameter, ...], Formula]:
        self._cursor.take()
        parameters = self.read_parameters()
        body = self.read_formula(scope | scope_of(parameters))
        self._cursor.take_bracket(")")
        return parameters, body

    def _read_atom(self, scope: Scope) -> Atom:
        """Read the rest of an atom and its closing bracket."""
        cursor = self._cursor
        if cursor.ahead == "=":
            return self._read_equality(scope)
        predicate = self._vocabulary.predicates.get(cursor.ahead)
        if predicate is None:
            self._refuse_head()
        cursor.take()
        return Atom(predicate.name, self._read_terms(predicate, scope))

    def _read_equality(self, scope: Scope) -> Atom:
        cursor = self._cursor
        cursor.take()
        start = cursor.taken
        self._requirements.use(":equality", start)
        if cursor.ahead == "(":
            raise cursor.source.error("numeric conditions are not supported", start, UnsupportedFeatureError)
        terms = []
        while not cursor.closes():
            terms.append(self._read_term(scope)[0])
        cursor.take()
        if len(terms) != 2:
            raise cursor.source.error(f"'=' takes 2 arguments, not {len(terms)}", start)
        return Atom("=", tuple(terms))

    def _refuse_head(self) -> NoReturn:
        """Say why a formula can't begin with the next token."""
        cursor, head = self._cursor, self._cursor.ahead
        if feature := _UNSUPPORTED.get(head):
            raise cursor.error(f"{feature} ('{head}') are not supported", UnsupportedFeatureError)
        if head in KEYWORDS:
            raise cursor.error(f"'{head}' can't stand here")
        cursor.take_name("a predicate")
        raise cursor.error_at_taken(f"undeclared predicate '{head}'")

    def _read_terms(self, owner: Predicate | Function, scope: Scope) -> tuple[str, ...]:
        """Read the arguments of a predicate or function and the closing bracket."""
        cursor = self._cursor
        start = cursor.taken
        terms: list[str] = []
        while not cursor.closes():
            term, types = self._read_term(scope)
            if len(terms) < len(owner.parameters):
                wanted = owner.parameters[len(terms)].types
                fits = self._vocabulary.fits if term[0] == "?" else self._vocabulary.belongs
                if not fits(types, wanted):
                    raise cursor.error_at_taken(
                        f"'{term}' is of type {_show(types)}, but argument {len(terms) + 1} of '{owner.name}'"
                        f" is of type {_show(wanted)}"
                    )
            terms.append(term)
        cursor.take()
        if len(terms) != len(owner.parameters):
            expected = f"{(n := len(owner.parameters))} argument{'s' * (n != 1)}"
            raise cursor.source.error(f"'{owner.name}' takes {expected}, not {len(terms)}", start)
        return tuple(terms)

    def _read_term(self, scope: Scope) -> tuple[str, tuple[str, ...]]:
        """Read a variable or an object, with its types."""
        cursor = self._cursor
        if cursor.ahead.startswith("?"):
            name = cursor.take_variable()
            if name not in scope:
                raise cursor.error_at_taken(f"unbound variable '{name}'")
            return name, scope[name]
        name = cursor.take_name("a variable or an object")
        if name not in self._vocabulary.objects:
            raise cursor.error_at_taken(f"undeclared object '{name}'")
        return name, self._vocabulary.objects[name]

    # Ground atoms and numbers

    def read_ground_atom(self) -> tuple[str, ...]:
        """Read one atom without variables, brackets included."""
        self._cursor.take_bracket("(")
        if self._cursor.ahead in KEYWORDS:
            self._refuse_head()
        atom = self._read_atom({})
        return (atom.predicate, *atom.terms)

    def read_function_term(self, scope: Scope) -> FunctionTerm:
        """Read ``(function term ...)``."""
        cursor = self._cursor
        cursor.take_bracket("(")
        if cursor.ahead in {"+", "-", "*", "/"}:
            raise cursor.error(f"arithmetic ('{cursor.ahead}') is not supported", UnsupportedFeatureError)
        name = cursor.take_name("a function")
        function = self._vocabulary.functions.get(name)
        if function is None:
            raise cursor.error_at_taken(f"undeclared function '{name}'")
        return FunctionTerm(name, self._read_terms(function, scope))

    def read_amount(self) -> int:
        """Read a cost: a whole number, not negative."""
        cursor = self._cursor
        token = cursor.ahead
        if match := _INTEGER.fullmatch(token):
            digits = match[1].lstrip("0")
            if len(digits) > len(str(MAX_COST)) or int(digits or "0") > MAX_COST:
                raise cursor.error(f"{token} is too large for a cost (at most {MAX_COST})")
            cursor.take()
            return int(digits or "0")
        if _DECIMAL.fullmatch(token):
            raise cursor.error(f"decimal costs ({token}) are not supported", UnsupportedFeatureError)
        if token.startswith("-") and (_INTEGER.fullmatch(token[1:]) or _DECIMAL.fullmatch(token[1:])):
            raise cursor.error(f"negative cost {token}")
        raise cursor.error(f"expected a number, not {cursor.shown}")


def scope_of(parameters: tuple[Parameter, ...]) -> Scope:
    """Return what parameters bring into sight."""
    return {parameter.name: parameter.types for parameter in parameters}


def _show(types: tuple[str, ...]) -> str:
    return f"'{types[0]}'" if len(types) == 1 else f"'(either {' '.join(types)})'"

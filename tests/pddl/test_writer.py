"""The writer: what it writes reads back as the same model."""

from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.model.problem import (
    TRUE,
    ActionSchema,
    And,
    Atom,
    Domain,
    Effect,
    Exists,
    Forall,
    Function,
    FunctionTerm,
    Not,
    Or,
    Parameter,
    Predicate,
    Problem,
    ancestors,
)
from explicable.pddl import format_domain, format_problem, parse_domain, parse_problem

NAMES = st.sampled_from(("a", "b", "c", "d-1", "e_2", "f.x", "at", "either", "9", "straße"))
REQUIREMENTS = st.frozensets(st.sampled_from([":strips", ":typing", ":adl", ":action-costs", ":equality"]))
COSTS = st.integers(0, 2**31 - 1)


def unique_names(max_size):
    return st.lists(NAMES, unique=True, max_size=max_size)


@st.composite
def type_tuples(draw, types):
    return tuple(draw(st.lists(st.sampled_from([*types, "object"]), min_size=1, max_size=2, unique=True)))


@st.composite
def parameter_tuples(draw, types, max_size=3):
    names = draw(st.lists(st.sampled_from(["?x", "?y", "?z", "?w"]), unique=True, max_size=max_size))
    return tuple(Parameter(name, draw(type_tuples(types))) for name in names)


class Writing:
    """Draws well-typed conditions and effects over one domain's names."""

    def __init__(self, draw, types, objects, predicates, functions):
        self.draw, self.types, self.objects = draw, types, objects
        self.predicates, self.functions = predicates, functions
        self.above = ancestors(types)

    def choose(self, *choices):
        return self.draw(st.sampled_from(choices))

    def term(self, wanted, scope):
        """A term that may stand where `wanted` is asked for, or None."""

        def belongs(kind):
            return "object" in wanted or not self.above[kind].isdisjoint(wanted)

        fitting = [p.name for p in scope if all(map(belongs, p.types))]
        fitting += [name for name, types in self.objects.items() if any(map(belongs, types))]
        return self.draw(st.sampled_from(fitting)) if fitting else None

    def applied(self, declared, scope):
        """Name and terms of a predicate or function, or None."""
        if not declared:
            return None
        head = self.draw(st.sampled_from(declared))
        terms = tuple(self.term(parameter.types, scope) for parameter in head.parameters)
        return None if None in terms else (head.name, terms)

    def formula(self, scope, depth=3):
        kind = self.choose("atom", "=", "not", "and", "or", "exists", "forall") if depth else "atom"
        if kind in {"exists", "forall"}:
            parameters = self.draw(parameter_tuples(self.types, max_size=2))
            hidden = {parameter.name for parameter in parameters}
            inner = (*parameters, *(p for p in scope if p.name not in hidden))
            return (Exists if kind == "exists" else Forall)(parameters, self.formula(inner, depth - 1))
        if kind in {"and", "or"}:
            parts = [self.formula(scope, depth - 1) for _ in range(self.draw(st.integers(0, 3)))]
            return (And if kind == "and" else Or)(tuple(parts))
        if kind == "not":
            return Not(self.formula(scope, depth - 1))
        terms = (self.term(("object",), scope), self.term(("object",), scope))
        if kind == "=" and None not in terms:
            return Atom("=", terms)
        atom = self.applied(self.predicates, scope)
        return TRUE if atom is None else Atom(*atom)

    def effects(self, scope):
        for _ in range(self.draw(st.integers(0, 3))):
            parameters = (
                self.draw(parameter_tuples(self.types, max_size=2)) if self.choose(True, False) else ()
            )
            hidden = {parameter.name for parameter in parameters}
            inner = (*parameters, *(p for p in scope if p.name not in hidden))
            condition = self.formula(inner, 2) if self.choose(True, False) else TRUE
            if atom := self.applied(self.predicates, inner):
                yield Effect(Atom(*atom), self.choose(True, False), condition, parameters)

    def costs(self, scope):
        for _ in range(self.draw(st.integers(0, 2))):
            term = self.applied(self.functions[1:], scope)
            yield self.draw(COSTS) if term is None or self.choose(True, False) else FunctionTerm(*term)

    def ground(self, declared):
        atoms = (self.applied(declared, ()) for _ in range(self.draw(st.integers(0, 8))))
        return [(name, *terms) for name, terms in filter(None, atoms)]


@st.composite
def problems(draw):
    names = draw(unique_names(4))
    types = {}
    for name in names:
        types[name] = draw(type_tuples(tuple(types)))
    types = dict(draw(st.permutations(list(types.items()))))
    kinds = tuple(types)
    objects = {name: draw(type_tuples(kinds)) for name in draw(unique_names(6))}
    split = draw(st.integers(0, len(objects)))
    constants, rest = dict(list(objects.items())[:split]), dict(list(objects.items())[split:])
    predicates = tuple(Predicate(n, draw(parameter_tuples(kinds))) for n in draw(unique_names(4)))
    functions = (
        Function("total-cost", ()),
        *(Function(n, draw(parameter_tuples(kinds))) for n in draw(unique_names(2))),
    )
    lifted = Writing(draw, types, constants, predicates, functions)
    actions = []
    for name in draw(unique_names(3)):
        scope = draw(parameter_tuples(kinds))
        effects, costs = tuple(lifted.effects(scope)), tuple(lifted.costs(scope))
        actions.append(ActionSchema(name, scope, lifted.formula(scope), effects, costs))
    domain = Domain(draw(NAMES), draw(REQUIREMENTS), types, constants, predicates, functions, tuple(actions))
    ground = Writing(draw, types, objects, predicates, functions)
    init = tuple(dict.fromkeys(ground.ground(predicates)))
    values = {term: draw(COSTS) for term in ground.ground(functions)}
    return Problem(draw(NAMES), domain, rest, init, ground.formula(()), values, draw(st.booleans()))


@settings(max_examples=30)
@given(problems())
def test_what_is_written_reads_back(problem):
    domain = parse_domain(format_domain(problem.domain))
    assert domain == problem.domain
    assert parse_problem(format_problem(problem), domain) == problem


def test_long_formulas_are_laid_out():
    goal = And(tuple(Not(Exists((Parameter("?x"),), Atom("at", ("?x", f"place-{i}")))) for i in range(3)))
    domain = parse_domain("(define (domain d) (:predicates (at ?x ?y)))")
    problem = Problem("p", domain, {f"place-{i}": ("object",) for i in range(3)}, (), goal, {})
    assert (
        format_problem(problem)
        == """\
(define (problem p)
  (:domain d)
  (:objects
    place-0 place-1 place-2)
  (:init)
  (:goal (and
    (not (exists (?x) (at ?x place-0)))
    (not (exists (?x) (at ?x place-1)))
    (not (exists (?x) (at ?x place-2))))))
"""
    )

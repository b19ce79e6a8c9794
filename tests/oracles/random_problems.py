"""Small random lifted problems that use everything PDDL offers here, or STRIPS only."""

from itertools import product

from explicable.model.problem import (
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
)

TYPES = {"thing": ("object",), "place": ("object",), "box": ("thing",)}
CONSTANTS = {"k": ("box",), "a": ("box",), "p": ("place",)}
OBJECTS = {"b": ("thing",), "q": ("place",)}


def atoms_of(predicate):
    return [
        (predicate.name, *names)
        for names in product([*CONSTANTS, *OBJECTS], repeat=len(predicate.parameters))
    ]


class ProblemMaker:
    def __init__(self, rng, *, strips=False):
        self.rng = rng
        self.strips = strips
        self.num_quantified = 0

    def problem(self):
        rng = self.rng
        self.predicates = tuple(
            Predicate(f"f{i}", tuple(Parameter(f"?x{j}") for j in range(rng.choice([0, 1, 1, 2]))))
            for i in range(rng.randint(2, 5))
        )
        self.fluent = [p for p in self.predicates if rng.random() < 0.9] or list(self.predicates[:1])
        self.functions = (Function("price", (Parameter("?x", ("place",)),)),)
        actions = tuple(self.action(f"act{i}") for i in range(rng.randint(2, 5)))
        domain = Domain("random", frozenset(), TYPES, CONSTANTS, self.predicates, self.functions, actions)
        density = rng.choice([0.1, 0.4, 0.7])
        init = tuple(atom for p in self.predicates for atom in atoms_of(p) if rng.random() < density)
        values = {("price", name): rng.randint(0, 5) for name in ("p", "q") if rng.random() < 0.9}
        goal = self.conjunction([], 2) if self.strips else self.formula([], 2)
        return Problem("random", domain, OBJECTS, init, goal, values, minimize_cost=rng.random() < 0.7)

    def parameters(self, number):
        kinds = [("object",), ("thing",), ("place",), ("box",)] + [("box", "place")] * (not self.strips)
        return tuple(Parameter(f"?v{i}", self.rng.choice(kinds)) for i in range(number))

    def quantified(self):
        self.num_quantified += 1
        names = (
            ["?v0"] if self.rng.random() < 0.2 else [f"?q{self.num_quantified}"]
        )  # one may hide a parameter
        return tuple(
            Parameter(name, self.rng.choice([("thing",), ("place",), ("object",)])) for name in names
        )

    def term(self, scope):
        if scope and self.rng.random() < 0.8:  # the innermost variable before others
            return self.rng.choice([*scope, scope[-1]])
        return self.rng.choice(list(CONSTANTS))

    def atom(self, scope, predicates=None):
        predicate = self.rng.choice(predicates or self.predicates)
        return Atom(predicate.name, tuple(self.term(scope) for _ in predicate.parameters))

    def conjunction(self, scope, most):
        return And(tuple(self.atom(scope) for _ in range(self.rng.randint(0, most))))

    def formula(self, scope, depth):
        rng = self.rng
        inner = ["and", "or", "exists", "forall", "not"]
        kind = rng.choice(["atom", "atom", "atom", "not", "not", "equal"] + inner * (depth > 0))
        match kind:
            case "atom":
                return self.atom(scope)
            case "equal":
                return Atom("=", (self.term(scope), self.term(scope)))
            case "not":
                return Not(self.formula(scope, depth - 1) if depth > 0 else self.atom(scope))
            case "and" | "or":
                parts = tuple(
                    self.formula(scope, depth - 1) for _ in range(rng.choice([0, 2, 2, 2, 2, 3, 3]))
                )
                return And(parts) if kind == "and" else Or(parts)
            case _:
                parameters = self.quantified()
                body = self.formula([*scope, *(p.name for p in parameters)], depth - 1)
                return Exists(parameters, body) if kind == "exists" else Forall(parameters, body)

    def effect(self, scope):
        rng = self.rng
        if self.strips or rng.random() < 0.4:
            return Effect(self.atom(scope, self.fluent), rng.random() < 0.6)
        parameters = self.quantified() if rng.random() < 0.5 else ()
        inner = [*scope, *(p.name for p in parameters)]
        condition = self.formula(inner, 1) if rng.random() < 0.9 else And()
        return Effect(self.atom(inner, self.fluent), rng.random() < 0.6, condition, parameters)

    def action(self, name):
        rng = self.rng
        parameters = self.parameters(rng.choice([0, 1, 1, 2, 2, 3]))
        scope = [p.name for p in parameters]
        precondition = self.conjunction(scope, 2)
        effects = tuple(self.effect(scope) for _ in range(rng.randint(0, 3)))
        names = {predicate.name for predicate in self.fluent}
        for atom in precondition.parts:  # now and then what is needed is exchanged for something like it
            if atom.predicate in names and atom.terms and rng.random() < 0.6:
                other = Atom(atom.predicate, (*atom.terms[:-1], self.term(scope)))
                effects += (Effect(atom, positive=False), Effect(other))
        if not self.strips and rng.random() < 0.7:
            precondition = And((*precondition.parts[:2], self.formula(scope, 2)))
        effects = effects or (self.effect(scope),)
        cost = (rng.randint(0, 3),)
        if not self.strips:
            cost += (FunctionTerm("price", (rng.choice([*scope, "p"]),)),)
        return ActionSchema(name, parameters, precondition, effects, cost)

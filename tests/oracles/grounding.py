"""Grounding the slow, obvious way: all tuples of objects, formulas evaluated as they stand."""

from itertools import product

from explicable.model.problem import And, Atom, Exists, Forall, Not, Or


def objects_of(problem, parameter):
    """Objects of a parameter's types, found by walking up the hierarchy."""

    def belongs(types):
        return any(t in parameter.types or belongs(problem.domain.types.get(t, ())) for t in types)

    everything = {**problem.domain.constants, **problem.objects}
    return [name for name, types in everything.items() if "object" in parameter.types or belongs(types)]


def bindings(problem, parameters, outer=None):
    names = [parameter.name for parameter in parameters]
    for objects in product(*(objects_of(problem, parameter) for parameter in parameters)):
        yield {**(outer or {}), **dict(zip(names, objects, strict=True))}


def substitute(atom, binding):
    return (atom.predicate, *(binding.get(term, term) for term in atom.terms))


def holds(problem, formula, binding, atoms):
    match formula:
        case Atom("=", (left, right)):
            return binding.get(left, left) == binding.get(right, right)
        case Atom():
            return substitute(formula, binding) in atoms
        case Not(body):
            return not holds(problem, body, binding, atoms)
        case And(parts):
            return all(holds(problem, part, binding, atoms) for part in parts)
        case Or(parts):
            return any(holds(problem, part, binding, atoms) for part in parts)
        case Exists(parameters, body):
            return any(holds(problem, body, inner, atoms) for inner in bindings(problem, parameters, binding))
        case Forall(parameters, body):
            return all(holds(problem, body, inner, atoms) for inner in bindings(problem, parameters, binding))


def all_actions(problem):
    """Every action of the problem with its schema and binding, possible or not."""
    for schema in problem.domain.actions:
        for binding in bindings(problem, schema.parameters):
            yield (schema.name, *(binding[p.name] for p in schema.parameters)), schema, binding


def applicable(problem, atoms):
    return {
        action: (schema, binding)
        for action, schema, binding in all_actions(problem)
        if holds(problem, schema.precondition, binding, atoms) and cost(problem, schema, binding) is not None
    }


def changes(problem, schema, binding, atoms):
    """What an action adds and deletes in a state."""
    adds, deletes = set(), set()
    for effect in schema.effects:
        for inner in bindings(problem, effect.parameters, binding):
            if holds(problem, effect.condition, inner, atoms):
                (adds if effect.positive else deletes).add(substitute(effect.atom, inner))
    return adds, deletes


def successor(problem, schema, binding, atoms):
    adds, deletes = changes(problem, schema, binding, atoms)
    return (atoms - deletes) | adds


def cost(problem, schema, binding):
    """What an action costs; None where a number in it is undefined."""
    if not problem.minimize_cost:
        return 1
    parts = [
        part
        if isinstance(part, int)
        else problem.values.get((part.name, *(binding.get(term, term) for term in part.terms)))
        for part in schema.cost
    ]
    return None if None in parts else sum(parts)


def relaxed_reachable(problem):
    """Atoms and actions that the delete relaxation of a STRIPS problem reaches."""
    atoms, actions, size = set(problem.init), {}, -1
    while size != len(atoms) + len(actions):
        size = len(atoms) + len(actions)
        actions = applicable(problem, atoms)
        for schema, binding in actions.values():
            atoms |= changes(problem, schema, binding, atoms)[0]
    return atoms, actions


def all_atoms(problem):
    """Every atom that the predicates' types allow."""
    for predicate in problem.domain.predicates:
        for binding in bindings(problem, predicate.parameters):
            yield (predicate.name, *(binding[p.name] for p in predicate.parameters))

"""Why a step is not possible, in the words of the domain.

Slow and plain: it runs once, when a plan is refused.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import product

from explicable.model.problem import (
    ActionSchema,
    And,
    Atom,
    Exists,
    Forall,
    Formula,
    GroundAtom,
    Not,
    Or,
    Parameter,
    Problem,
    conjuncts,
    supertypes,
)

Binding = Mapping[str, str]


def object_to_step(problem: Problem, action: GroundAtom, is_true: Callable[[GroundAtom], bool]) -> str:
    """Say what a step that is not applicable lacks, or why it is none.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> problem = encode(World(("@*",))).robot
    >>> object_to_step(problem, ("move", "r1", "c-0-0", "c-0-1"), lambda atom: atom[0] == "at")
    'lacks (adjacent c-0-0 c-0-1)'
    """
    schema = next((schema for schema in problem.domain.actions if action[:1] == (schema.name,)), None)
    if schema is None:
        return "is no action of the domain"
    if len(action) - 1 != len(schema.parameters):
        return f"has {len(action) - 1} arguments instead of {len(schema.parameters)}"
    for name in action[1:]:
        if name not in problem.domain.constants and name not in problem.objects:
            return f"names an unknown object, {name}"
    binding = {p.name: name for p, name in zip(schema.parameters, action[1:], strict=True)}
    failing = _failing_part(problem, schema, binding, is_true)
    if failing is None:
        return "is not possible in this task"
    return f"lacks {format_formula(failing, binding)}"


def _failing_part(
    problem: Problem, schema: ActionSchema, binding: Binding, is_true: Callable[[GroundAtom], bool]
) -> Formula | None:
    """Return the first conjunct of an action's precondition that fails, or None if all hold."""

    def objects(parameter: Parameter) -> Iterator[str]:
        for name, types in {**problem.domain.constants, **problem.objects}.items():
            if not supertypes(problem.domain, types).isdisjoint(parameter.types):
                yield name

    def bindings(parameters: tuple[Parameter, ...], outer: Binding) -> Iterator[Binding]:
        for names in product(*map(objects, parameters)):
            yield {**outer, **dict(zip((p.name for p in parameters), names, strict=True))}

    def holds(formula: Formula, binding: Binding) -> bool:
        match formula:
            case Atom(predicate, terms):
                names = [binding.get(term, term) for term in terms]
                return names[0] == names[1] if predicate == "=" else is_true((predicate, *names))
            case Not(body):
                return not holds(body, binding)
            case And(parts):
                return all(holds(part, binding) for part in parts)
            case Or(parts):
                return any(holds(part, binding) for part in parts)
            case Exists(parameters, body):
                return any(holds(body, inner) for inner in bindings(parameters, binding))
            case Forall(parameters, body):
                return all(holds(body, inner) for inner in bindings(parameters, binding))

    for parameter in schema.parameters:
        if binding[parameter.name] not in objects(parameter):
            return Atom(format_types(parameter.types), (parameter.name,))
    return next((part for part in conjuncts(schema.precondition) if not holds(part, binding)), None)


def format_formula(formula: Formula, binding: Binding) -> str:
    """Write a formula as PDDL does, with objects in the place of bound variables.

    Examples
    --------
    >>> format_formula(Not(Atom("at", ("?r", "hall"))), {"?r": "r1"})
    '(not (at r1 hall))'
    """

    def write(operator: str, parts: Iterable[Formula]) -> str:
        return f"({' '.join([operator, *(format_formula(part, binding) for part in parts)])})"

    match formula:
        case Atom(predicate, terms):
            return f"({' '.join([predicate, *(binding.get(term, term) for term in terms)])})"
        case Not(body):
            return write("not", (body,))
        case And(parts):
            return write("and", parts)
        case Or(parts):
            return write("or", parts)
        case Exists(parameters, body) | Forall(parameters, body):
            quantifier = "exists" if isinstance(formula, Exists) else "forall"
            variables = " ".join(f"{p.name} - {format_types(p.types)}" for p in parameters)
            free = {
                name: value for name, value in binding.items() if name not in {p.name for p in parameters}
            }
            return f"({quantifier} ({variables}) {format_formula(body, free)})"


def format_types(types: tuple[str, ...]) -> str:
    """Write the types of a parameter or object as PDDL does.

    Examples
    --------
    >>> format_types(("cart", "truck"))
    '(either cart truck)'
    """
    return types[0] if len(types) == 1 else f"(either {' '.join(types)})"

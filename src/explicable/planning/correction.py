"""What the person's model of the robots becomes when they are told of differences."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from explicable.model.problem import ActionSchema, And, Effect, Problem, conjuncts
from explicable.model.team import TeamProblem
from explicable.planning.differences import Difference, FactDifference, SchemaDifference, ValueDifference
from explicable.planning.schemas import renamed, terms


def correct(problem: TeamProblem, told: Iterable[Difference]) -> TeamProblem:
    """Return the team problem after the person was told of some differences.

    What the robots and humans can really do, the composite task, stays the same.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.planning.differences import find_differences
    >>> team = encode(World(("@x*", "..o")))
    >>> find_differences(correct(team, find_differences(team)))
    ()
    """
    human = _declare(problem.mental, problem.robot, told := tuple(told))
    init = dict.fromkeys(human.init)
    values = dict(human.values)
    schemas = {schema.name: schema for schema in human.domain.actions}
    own = {schema.name: schema for schema in problem.robot.domain.actions}
    for difference in told:
        match difference:
            case FactDifference(atom, holds=True):
                init[atom] = None
            case FactDifference(atom):
                init.pop(atom, None)
            case ValueDifference(term, value):
                values[term] = value
            case SchemaDifference(name, ActionSchema() as whole, present):
                if present:
                    schemas[name] = whole
                else:
                    del schemas[name]
            case SchemaDifference(name):
                schema = renamed(schemas[name], own[name])
                if schema is not None:
                    schemas[name] = _corrected(schema, difference)
    domain = replace(human.domain, actions=tuple(schemas.values()))
    return replace(problem, human=replace(human, domain=domain, init=tuple(init), values=values))


def _corrected(schema: ActionSchema, difference: SchemaDifference) -> ActionSchema:
    """Put a part into a schema, or take it out."""
    match difference.part:
        case Effect() as effect:
            others = tuple(other for other in schema.effects if other != effect)
            return replace(schema, effects=(*others, effect) if difference.present else others)
        case tuple(cost):
            return replace(schema, cost=cost)
        case formula:  # the only kind left, which mypy does not see
            parts = tuple(part for part in conjuncts(schema.precondition) if part != formula)
            return replace(
                schema,
                precondition=And((*parts, formula) if difference.present else parts),  # type: ignore[arg-type]
            )


def _declare(human: Problem, robot: Problem, told: Iterable[Difference]) -> Problem:
    """Declare what telling needs words for; without facts, types and predicates mean nothing yet."""
    domain = human.domain
    predicates = {predicate.name for predicate in domain.predicates}
    functions = {function.name for function in domain.functions}
    known = {*human.objects, *domain.constants}
    everything = {**robot.domain.constants, **robot.objects}
    named = {name for difference in told for name in _objects(difference)}
    return replace(
        human,
        domain=replace(
            domain,
            types={**robot.domain.types, **domain.types},
            predicates=(
                *domain.predicates,
                *(p for p in robot.domain.predicates if p.name not in predicates),
            ),
            functions=(*domain.functions, *(f for f in robot.domain.functions if f.name not in functions)),
        ),
        objects={
            **human.objects,
            **{name: types for name, types in everything.items() if name in named - known},
        },
    )


def _objects(difference: Difference) -> Iterator[str]:
    """Names of objects that a difference mentions: constants, where it is one of schemas."""
    if not isinstance(difference, SchemaDifference):
        yield from difference.names
        return
    match difference.part:
        case ActionSchema(_, _, precondition, effects):
            formulas = [precondition, *(f for e in effects for f in (e.atom, e.condition))]
        case Effect(atom, _, condition):
            formulas = [atom, condition]
        case tuple():
            formulas = []
        case formula:
            formulas = [formula]
    for formula in formulas:
        yield from (term for term in terms(formula) if not term.startswith("?"))

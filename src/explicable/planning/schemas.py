"""Action schemas taken apart, and compared whatever their parameters are called."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from explicable.model.problem import ActionSchema, And, Atom, Exists, Forall, Formula, Not, Or


def renamed(schema: ActionSchema, like: ActionSchema) -> ActionSchema | None:
    """Give a schema the parameter names of another.

    Returns
    -------
    ActionSchema or None
        None if the two differ in the types of parameters, or a quantified variable gets in the way.
    """
    if [p.types for p in schema.parameters] != [p.types for p in like.parameters]:
        return None
    if schema.parameters == like.parameters:
        return schema
    names = {p.name: q.name for p, q in zip(schema.parameters, like.parameters, strict=True)}
    conditions = (schema.precondition, *(effect.condition for effect in schema.effects))
    bound = {name for formula in conditions for name in _bound(formula)}
    bound |= {parameter.name for effect in schema.effects for parameter in effect.parameters}
    if bound & {*names, *names.values()}:
        return None  # renaming would have to mind what hides what
    return ActionSchema(
        name=schema.name,
        parameters=like.parameters,
        precondition=_substituted(schema.precondition, names),
        effects=tuple(
            replace(e, atom=_renamed_atom(e.atom, names), condition=_substituted(e.condition, names))
            for e in schema.effects
        ),
        cost=tuple(
            a if isinstance(a, int) else replace(a, terms=tuple(names.get(t, t) for t in a.terms))
            for a in schema.cost
        ),
    )


def _substituted(formula: Formula, names: Mapping[str, str]) -> Formula:
    match formula:
        case Atom():
            return _renamed_atom(formula, names)
        case Not(body):
            return Not(_substituted(body, names))
        case And(parts) | Or(parts):
            return replace(formula, parts=tuple(_substituted(part, names) for part in parts))
        case Exists(_, body) | Forall(_, body):
            return replace(formula, body=_substituted(body, names))


def _renamed_atom(atom: Atom, names: Mapping[str, str]) -> Atom:
    return replace(atom, terms=tuple(names.get(term, term) for term in atom.terms))


def _subformulas(formula: Formula) -> Iterator[Formula]:
    yield formula
    match formula:
        case Not(body) | Exists(_, body) | Forall(_, body):
            yield from _subformulas(body)
        case And(parts) | Or(parts):
            for part in parts:
                yield from _subformulas(part)


def _bound(formula: Formula) -> Iterator[str]:
    for part in _subformulas(formula):
        if isinstance(part, Exists | Forall):
            yield from (parameter.name for parameter in part.parameters)


def terms(formula: Formula) -> Iterator[str]:
    """Yield the terms of a formula's atoms, variables and objects."""
    for part in _subformulas(formula):
        if isinstance(part, Atom):
            yield from part.terms

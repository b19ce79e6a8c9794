"""PDDL text -> model, with every name checked and every error placed."""

from collections.abc import Mapping
from pathlib import Path

from explicable.errors import UnsupportedFeatureError
from explicable.model.problem import (
    TRUE,
    ActionSchema,
    Domain,
    Formula,
    Function,
    Parameter,
    Predicate,
    Problem,
    ancestors,
)
from explicable.pddl.declarations import (
    name_once,
    read_functions,
    read_predicates,
    read_requirements,
    read_typed_list,
    read_types,
)
from explicable.pddl.effects import EffectList, EffectReader
from explicable.pddl.formulas import MAX_COST, FormulaReader, scope_of
from explicable.pddl.initial_state import read_init
from explicable.pddl.source import Cursor, Source, Warn
from explicable.pddl.vocabulary import Requirements, Vocabulary

_DOMAIN_SECTIONS = (
    ":requirements",
    ":types",
    ":constants",
    ":predicates",
    ":functions",
    ":action",
)
_PROBLEM_SECTIONS = (":domain", ":requirements", ":objects", ":init", ":goal", ":metric", ":length")
_UNSUPPORTED_SECTIONS = {
    ":durative-action": "durative actions",
    ":derived": "derived predicates",
    ":axiom": "axioms",
    ":constraints": "constraints",
    ":safety": "safety constraints",
    ":process": "processes",
    ":event": "events",
    ":extends": "domains that extend others",
    ":timeless": "timeless facts",
    ":situation": "named initial situations",
    ":method": "hierarchical tasks",
    ":task": "hierarchical tasks",
    ":tasks": "hierarchical tasks",
    ":htn": "hierarchical tasks",
    ":observe": "sensing",
}


def parse_domain(text: str, path: str | Path | None = None, *, warn: Warn | None = None) -> Domain:
    """Read a domain.

    Parameters
    ----------
    text
        The domain in PDDL.
    path
        File that it came from, for messages.
    warn
        Called with each `PDDLWarning`.

    Raises
    ------
    PDDLError
        If the text is not a domain; says where and why. `UnsupportedFeatureError` if it is one, but asks for
        something that this package does not plan for.

    Examples
    --------
    >>> domain = parse_domain("(define (domain lamp) (:predicates (on)) (:action press :effect (on)))")
    >>> domain.actions[0].effects[0].atom
    Atom(predicate='on', terms=())
    """
    source = Source(text, path, warn)
    name, sections = _open(source, "domain", _DOMAIN_SECTIONS)
    requirements = Requirements(_read_declared(source, sections), source)
    types: dict[str, tuple[str, ...]] = {}
    for offset in sections.get(":types", ()):
        requirements.use(":typing", offset)
        types = read_types(_enter(source, offset), requirements)
    above = ancestors(types)
    constants: dict[str, tuple[str, ...]] = {}
    for offset in sections.get(":constants", ()):
        entries = read_typed_list(_enter(source, offset), "a constant", requirements, above)
        constants = name_once(entries, source, "constant", {})
    predicates: tuple[Predicate, ...] = ()
    for offset in sections.get(":predicates", ()):
        predicates = read_predicates(_enter(source, offset), above, requirements)
    functions: tuple[Function, ...] = ()
    for offset in sections.get(":functions", ()):
        requirements.use(":action-costs", offset)
        functions = read_functions(_enter(source, offset), above, requirements)
    vocabulary = Vocabulary(above, constants, predicates, functions)
    actions: dict[str, ActionSchema] = {}
    for offset in sections.get(":action", ()):
        cursor = _enter(source, offset)
        schema = cursor.take_name("the action's name")
        if schema in actions:
            raise cursor.error_at_taken(f"action '{schema}' is declared twice")
        actions[schema] = _read_action(schema, cursor, vocabulary, requirements)
    return Domain(
        name, requirements.declared, types, constants, predicates, functions, tuple(actions.values())
    )


def parse_problem(
    text: str, domain: Domain, path: str | Path | None = None, *, warn: Warn | None = None
) -> Problem:
    """Read a problem over a domain.

    Parameters
    ----------
    text
        The problem in PDDL.
    domain
        The domain that it names.
    path
        File that it came from, for messages.
    warn
        Called with each `PDDLWarning`.

    Raises
    ------
    PDDLError
        As for `parse_domain`.

    Examples
    --------
    >>> domain = parse_domain("(define (domain lamp) (:predicates (on)))")
    >>> problem = parse_problem("(define (problem p) (:domain lamp) (:init) (:goal (on)))", domain)
    >>> problem.goal
    Atom(predicate='on', terms=())
    """
    source = Source(text, path, warn)
    name, sections = _open(source, "problem", _PROBLEM_SECTIONS)
    for keyword in (":domain", ":init", ":goal"):
        if keyword not in sections:
            raise source.error(f"the problem has no '({keyword} ...)'", source.text.index("("))
    _check_domain_name(_enter(source, sections[":domain"][0]), domain.name)
    requirements = Requirements(domain.requirements | _read_declared(source, sections), source)
    above = ancestors(domain.types)
    objects: dict[str, tuple[str, ...]] = {}
    for offset in sections.get(":objects", ()):
        entries = read_typed_list(_enter(source, offset), "an object", requirements, above)
        objects = name_once(entries, source, "object", domain.constants)
    vocabulary = Vocabulary(above, {**domain.constants, **objects}, domain.predicates, domain.functions)
    init, values = read_init(_enter(source, sections[":init"][0]), vocabulary, requirements)
    cursor = _enter(source, sections[":goal"][0])
    goal = FormulaReader(cursor, vocabulary, requirements).read_formula({})
    cursor.take_bracket(")")
    for offset in sections.get(":metric", ()):
        _read_metric(_enter(source, offset), vocabulary)
    return Problem(name, domain, objects, init, goal, values, ":metric" in sections)


def _open(source: Source, kind: str, allowed: tuple[str, ...]) -> tuple[str, dict[str, list[int]]]:
    """Give the name in ``(domain name)`` or ``(problem name)``, and where each section begins."""
    name = ""
    sections: dict[str, list[int]] = {}
    for offset in source.sections():
        cursor = Cursor(source, offset)
        cursor.take()
        if not name:
            name = _read_name(cursor, kind)
        elif cursor.ahead in _UNSUPPORTED_SECTIONS:
            feature = _UNSUPPORTED_SECTIONS[cursor.ahead]
            raise cursor.error(f"{feature} ('{cursor.ahead}') are not supported", UnsupportedFeatureError)
        elif cursor.ahead not in allowed:
            raise cursor.error(f"expected a section of a {kind}, not {cursor.shown}")
        elif cursor.ahead in sections and cursor.ahead != ":action":
            raise cursor.error(f"'{cursor.ahead}' is given twice")
        else:
            sections.setdefault(cursor.ahead, []).append(offset)
    if not name:
        raise source.error(f"expected '({kind} ...)' after 'define'", source.text.index("define"))
    return name, sections


def _read_name(cursor: Cursor, kind: str) -> str:
    if cursor.ahead != kind:
        raise cursor.error(f"expected '{kind}', not {cursor.shown}")
    cursor.take()
    name = cursor.take_name(f"the {kind}'s name")
    cursor.take_bracket(")")
    return name


def _enter(source: Source, offset: int) -> Cursor:
    """Give a cursor behind the keyword of a section."""
    cursor = Cursor(source, offset)
    cursor.take()
    cursor.take()
    return cursor


def _read_declared(source: Source, sections: Mapping[str, list[int]]) -> frozenset[str]:
    if ":requirements" not in sections:
        return frozenset((":strips",))
    return read_requirements(_enter(source, sections[":requirements"][0]))


def _read_action(
    name: str, cursor: Cursor, vocabulary: Vocabulary, requirements: Requirements
) -> ActionSchema:
    """Read what follows an action's name."""
    reader = EffectReader(cursor, vocabulary, requirements)
    parameters: tuple[Parameter, ...] = ()
    scope: dict[str, tuple[str, ...]] = {}
    precondition: Formula = TRUE
    effect = EffectList()
    given: set[str] = set()
    while not cursor.closes():
        keyword = cursor.ahead
        if keyword in given:
            raise cursor.error(f"'{keyword}' is given twice")
        if keyword == ":parameters" and given:
            raise cursor.error("':parameters' has to come first")
        given.add(keyword)
        match keyword:
            case ":parameters":
                cursor.take()
                parameters = reader.read_parameters()
                scope = scope_of(parameters)
            case ":precondition":
                cursor.take()
                precondition = reader.read_formula(scope)
            case ":effect":
                cursor.take()
                start = cursor.start
                effect = reader.read_effect(scope)
                if sum(amount for amount in effect.cost if isinstance(amount, int)) > MAX_COST:
                    raise cursor.source.error(f"costs that add up to more than {MAX_COST}", start)
            case ":vars" | ":duration" | ":condition" | ":observe" | ":expansion" | ":agent":
                raise cursor.error(f"'{keyword}' of an action is not supported", UnsupportedFeatureError)
            case _:
                raise cursor.error(
                    f"expected ':parameters', ':precondition' or ':effect', not {cursor.shown}"
                )
    return ActionSchema(name, parameters, precondition, tuple(effect.effects), tuple(effect.cost))


def _check_domain_name(cursor: Cursor, wanted: str) -> None:
    name = cursor.take_name("the domain's name")
    if name != wanted:
        raise cursor.error_at_taken(f"the problem is for domain '{name}', not '{wanted}'")
    cursor.take_bracket(")")


def _read_metric(cursor: Cursor, vocabulary: Vocabulary) -> None:
    """Read the rest of ``(:metric minimize (total-cost))``, the only metric planned for."""
    start = cursor.start
    goal = cursor.take()
    bracketed = cursor.ahead == "("
    if bracketed:
        cursor.take()
    measure = cursor.take()
    if goal not in {"minimize", "maximize"}:
        raise cursor.source.error("expected 'minimize' or 'maximize'", start)
    if goal != "minimize" or measure != "total-cost":
        message = "metrics other than 'minimize (total-cost)' are not supported"
        raise cursor.source.error(message, start, UnsupportedFeatureError)
    if "total-cost" not in vocabulary.functions:
        raise cursor.error_at_taken("undeclared function 'total-cost'")
    if bracketed:
        cursor.take_bracket(")")
    cursor.take_bracket(")")

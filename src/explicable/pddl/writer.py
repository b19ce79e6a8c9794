"""Model -> PDDL text that people and other tools can read; reading it back gives the same model."""

from collections.abc import Iterable, Mapping

from explicable.model.problem import (
    TRUE,
    ActionSchema,
    And,
    Atom,
    Domain,
    Effect,
    Exists,
    Forall,
    Formula,
    Function,
    FunctionTerm,
    Not,
    Or,
    Parameter,
    Predicate,
    Problem,
)

_WIDTH = 100

# A formula on its way to text: a word, or a list in brackets.
_Expression = str | tuple["_Expression", ...]


def format_domain(domain: Domain) -> str:
    """Write a domain as PDDL.

    Examples
    --------
    >>> from explicable.pddl import parse_domain
    >>> domain = parse_domain("(define (domain lamp) (:predicates (on)) (:action press :effect (on)))")
    >>> print(format_domain(domain))
    (define (domain lamp)
      (:requirements :strips)
      (:predicates
        (on))
      (:action press
        :parameters ()
        :effect (on)))
    <BLANKLINE>
    """
    sections = [
        f"({' '.join((':requirements', *sorted(domain.requirements)))})",
        *_section(":types", _typed_lines(domain.types)),
        *_section(":constants", _typed_lines(domain.constants)),
        *_section(":predicates", (_flat(_signature(predicate)) for predicate in domain.predicates)),
        *_section(":functions", (f"{_flat(_signature(f))} - number" for f in domain.functions)),
        *(_format_action(action) for action in domain.actions),
    ]
    return "\n  ".join((f"(define (domain {domain.name})", *sections)) + ")\n"


def format_problem(problem: Problem) -> str:
    """Write a problem as PDDL, without its domain.

    Examples
    --------
    >>> from explicable.pddl import parse_domain, parse_problem
    >>> domain = parse_domain("(define (domain lamp) (:predicates (on)))")
    >>> problem = parse_problem("(define (problem p) (:domain lamp) (:init) (:goal (on)))", domain)
    >>> print(format_problem(problem))
    (define (problem p)
      (:domain lamp)
      (:init)
      (:goal (on)))
    <BLANKLINE>
    """
    values = (f"(= ({' '.join(term)}) {value})" for term, value in problem.values.items())
    init = (*(f"({' '.join(atom)})" for atom in problem.init), *values)
    sections = [
        f"(:domain {problem.domain.name})",
        *_section(":objects", _typed_lines(problem.objects)),
        *(_section(":init", init) or ["(:init)"]),
        f"(:goal {_layout(_formula(problem.goal), indent=4, used=9)})",
        *(["(:metric minimize (total-cost))"] if problem.minimize_cost else []),
    ]
    return "\n  ".join((f"(define (problem {problem.name})", *sections)) + ")\n"


def _section(keyword: str, lines: Iterable[str]) -> list[str]:
    lines = tuple(lines)
    return ["\n    ".join((f"({keyword}", *lines)) + ")"] if lines else []


def _format_action(action: ActionSchema) -> str:
    effects: list[_Expression] = [_effect(effect) for effect in action.effects]
    effects += [("increase", ("total-cost",), _amount(amount)) for amount in action.cost]
    parts: dict[str, _Expression] = {":parameters": _typed(action.parameters)}
    if action.precondition != TRUE:
        parts[":precondition"] = _formula(action.precondition)
    parts[":effect"] = effects[0] if len(effects) == 1 else ("and", *effects)
    lines = (f"{key} {_layout(part, indent=6, used=5 + len(key))}" for key, part in parts.items())
    return "\n    ".join((f"(:action {action.name}", *lines)) + ")"


def _formula(formula: Formula) -> tuple[_Expression, ...]:
    match formula:
        case Atom(predicate, terms):
            return (predicate, *terms)
        case Not(body):
            return ("not", _formula(body))
        case And(parts):
            return ("and", *map(_formula, parts))
        case Or((Not(left), right)):  # as `imply` is read
            return ("imply", _formula(left), _formula(right))
        case Or(parts):
            return ("or", *map(_formula, parts))
        case Exists(parameters, body):
            return ("exists", _typed(parameters), _formula(body))
        case Forall(parameters, body):
            return ("forall", _typed(parameters), _formula(body))


def _effect(effect: Effect) -> _Expression:
    expression: _Expression = _formula(effect.atom if effect.positive else Not(effect.atom))
    if effect.condition != TRUE:
        expression = ("when", _formula(effect.condition), expression)
    if effect.parameters:
        expression = ("forall", _typed(effect.parameters), expression)
    return expression


def _amount(amount: int | FunctionTerm) -> _Expression:
    return str(amount) if isinstance(amount, int) else (amount.name, *amount.terms)


def _signature(declared: Predicate | Function) -> tuple[_Expression, ...]:
    return (declared.name, *_typed(declared.parameters))


def _typed(parameters: Iterable[Parameter]) -> tuple[_Expression, ...]:
    words: list[_Expression] = []
    for names, kind in _grouped((parameter.name, parameter.types) for parameter in parameters):
        words += names if kind is None else [*names, "-", kind]
    return tuple(words)


def _typed_lines(names: Mapping[str, tuple[str, ...]]) -> list[str]:
    """Write one line for each run of names of the same type."""
    lines = []
    for group, kind in _grouped(names.items()):
        listed = " ".join(group)
        lines.append(listed if kind is None else f"{listed} - {_flat(kind)}")
    return lines


def _grouped(
    entries: Iterable[tuple[str, tuple[str, ...]]],
) -> list[tuple[list[str], _Expression | None]]:
    """Gather neighbours of the same type; None is a type that need not be written, at the end of a list."""
    groups: list[tuple[list[str], tuple[str, ...]]] = []
    for name, types in entries:
        if groups and groups[-1][1] == types:
            groups[-1][0].append(name)
        else:
            groups.append(([name], types))
    shown: list[tuple[list[str], _Expression | None]] = [
        (names, types[0] if len(types) == 1 else ("either", *types)) for names, types in groups
    ]
    if groups and groups[-1][1] == ("object",):
        shown[-1] = (groups[-1][0], None)
    return shown


def _flat(expression: _Expression) -> str:
    return expression if isinstance(expression, str) else f"({' '.join(map(_flat, expression))})"


def _layout(expression: _Expression, indent: int, used: int) -> str:
    """Write an expression behind `used` characters: on the same line if it fits, else its parts below."""
    flat = _flat(expression)
    if used + len(flat) <= _WIDTH or isinstance(expression, str) or len(expression) < 2:
        return flat
    num_inline = 2 if expression[0] in {"exists", "forall"} else 1
    head = " ".join(map(_flat, expression[:num_inline]))
    lines = (_layout(part, indent + 2, indent) for part in expression[num_inline:])
    return ("\n" + " " * indent).join((f"({head}", *lines)) + ")"

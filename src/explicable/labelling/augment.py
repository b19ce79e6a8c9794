"""The paper's features, ground symbols, and its remedy for their hold on names: permuted copies of traces.

Lifted features need neither (method.md, section 3): they are the faithful option and a test of invariance.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

import numpy as np

from explicable.model.problem import GroundAtom, Problem

Answer = TypeVar("Answer")


def ground_symbol_features(actions: Sequence[GroundAtom], *, window: int = 0) -> list[list[str]]:
    """Return each step's symbols as features: the schema, each argument with its place, the whole action.

    Parameters
    ----------
    actions
        Steps of a plan.
    window
        How many steps before each step lend their symbols too.

    Examples
    --------
    >>> ground_symbol_features([("visit", "r1", "kitchen")])
    [['visit', '1=r1', '2=kitchen', '(visit r1 kitchen)']]
    >>> ground_symbol_features([("wait", "r1"), ("wait", "r2")], window=1)[1]
    ['wait', '1=r2', '(wait r2)', 'before 1: wait', 'before 1: 1=r1', 'before 1: (wait r1)']
    """
    symbols = [
        [
            schema,
            *(f"{place}={name}" for place, name in enumerate(arguments, start=1)),
            f"({' '.join(action)})",
        ]
        for action in actions
        for schema, *arguments in [action]
    ]
    return [
        own
        + [
            f"before {back}: {symbol}"
            for back in range(1, min(window, step) + 1)
            for symbol in symbols[step - back]
        ]
        for step, own in enumerate(symbols)
    ]


def interchangeable_objects(problem: Problem) -> list[tuple[str, ...]]:
    """Return the problem's objects in groups of equal declared type; constants keep their names.

    Examples
    --------
    >>> from explicable.pddl.parser import parse_domain, parse_problem
    >>> domain = parse_domain("(define (domain d) (:requirements :typing) (:types room robot))")
    >>> problem = parse_problem(
    ...     "(define (problem p) (:domain d) (:objects a b - room r - robot) (:init) (:goal (and)))", domain
    ... )
    >>> interchangeable_objects(problem)
    [('a', 'b'), ('r',)]
    """
    groups: dict[tuple[str, ...], list[str]] = {}
    for name, types in problem.objects.items():
        groups.setdefault(types, []).append(name)
    return [tuple(names) for names in groups.values()]


def random_permutations(
    rng: np.random.Generator, groups: Iterable[Sequence[str]], num_permutations: int
) -> Iterator[dict[str, str]]:
    """Yield random permutations of symbols, each symbol going to one of its own group.

    Permutations are drawn with repetition; with few symbols some will be alike.

    Examples
    --------
    >>> list(random_permutations(np.random.default_rng(1), [("a", "b"), ("r",)], 1))
    [{'a': 'a', 'b': 'b', 'r': 'r'}]
    """
    groups = [tuple(group) for group in groups]
    for _ in range(num_permutations):
        yield {
            name: group[place]
            for group in groups
            for name, place in zip(group, rng.permutation(len(group)), strict=True)
        }


def permute(actions: Iterable[GroundAtom], permutation: Mapping[str, str]) -> tuple[GroundAtom, ...]:
    """Return the steps with their objects renamed; what has no new name keeps its own.

    Examples
    --------
    >>> permute([("go", "a", "b")], {"a": "b", "b": "a", "go": "a"})
    (('go', 'b', 'a'),)
    """
    return tuple((schema, *(permutation.get(name, name) for name in names)) for schema, *names in actions)


def augment(
    rng: np.random.Generator,
    traces: Iterable[tuple[Problem, Sequence[GroundAtom], Answer]],
    num_permutations: int,
) -> Iterator[tuple[tuple[GroundAtom, ...], Answer]]:
    """Yield each trace's steps with its labels, then `num_permutations` copies under random permutations.

    Traces of the same problem share their permutations, as in the paper ("for each problem").

    Parameters
    ----------
    rng
        Source of the permutations.
    traces
        Problem, steps and labels of each trace.
    num_permutations
        Copies of each trace, beside the trace itself (the paper: 1000).
    """
    permutations: dict[
        int, tuple[Problem, list[dict[str, str]]]
    ] = {}  # keeps the problem: its id stays its own
    for problem, actions, labels in traces:
        if id(problem) not in permutations:
            groups = interchangeable_objects(problem)
            permutations[id(problem)] = problem, list(random_permutations(rng, groups, num_permutations))
        yield tuple(actions), labels
        for permutation in permutations[id(problem)][1]:
            yield permute(actions, permutation), labels

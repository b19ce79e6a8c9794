"""Cheapest ways for those who ask for many, each of them short."""

from collections.abc import Sequence
from typing import NamedTuple

from explicable import _core
from explicable.model.task import State, Task

_MEMORY_BYTES = 2**26


class Way(NamedTuple):
    """A way through a task: its operators, and the states before and after each; no states: there is none."""

    operators: Sequence[int]
    states: Sequence[State]


def find_way(task: Task, state: State, goal: Sequence[int], *, max_evaluations: int = 10_000) -> Way | None:
    """Find a cheapest way from a state to some facts, as ``search(task, "astar", heuristic="tour")`` does.

    What `search` adds, a start-up for every algorithm and a report, takes several times as long as most such
    ways. In return it can't be interrupted, so that it should not take long.

    Parameters
    ----------
    goal
        Facts, by number.
    max_evaluations
        States to look at; 10 000 take a fraction of a second.

    Returns
    -------
    Way, or None
        None where a limit was reached, of evaluations or 64 MiB of memory: then `search` can say more.

    Examples
    --------
    >>> from explicable.model.grounding import ground
    >>> from explicable.model.problem import ActionSchema, And, Atom, Domain, Effect, Predicate, Problem
    >>> lamp = Atom("on", ())
    >>> switch = ActionSchema("switch", (), And(), (Effect(lamp),))
    >>> domain = Domain("room", frozenset(), {}, {}, (Predicate("on", ()),), (), (switch,))
    >>> task = ground(Problem("dark", domain, {}, (), lamp, {}))
    >>> way = find_way(task, task.initial_state, task.goal)
    >>> [task.action(operator) for operator in way.operators], len(way.states)
    ([('switch',)], 2)
    """
    found = _core.cheapest_way(task.core, state, goal, max_evaluations, _MEMORY_BYTES)
    return None if found is None else Way(found[0], list(map(State, found[1])))

"""Labellers written in Python: whatever can count the inexplicable steps of a plan can guide the search."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from explicable import _core
from explicable.model.problem import GroundAtom
from explicable.model.task import Task

Count = Callable[[tuple[GroundAtom, ...], tuple[GroundAtom, ...]], float]
"""Given a path from the initial state and a relaxed plan from there: the inexplicable steps in both."""


def scorer_of(task: Task, count: Count) -> _core.PathScorer:
    """Make a scorer for `search` of a function that counts inexplicable steps.

    The search asks it for every state that it evaluates: much slower than `Labeller.scorer`, but the function
    may look at whatever it likes in the whole path. Make a new scorer for each search: it keeps all paths.

    Parameters
    ----------
    task
        What is searched.
    count
        Called with the actions of a path from the initial state, and of a relaxed plan from its end, which
        need not be executable; returns how many of all these are inexplicable, by expectation or not.

    Examples
    --------
    Nobody expects the light to be switched on twice in a row:

    >>> from explicable.model.grounding import ground
    >>> from explicable.model.problem import ActionSchema, And, Atom, Domain, Effect, Predicate, Problem
    >>> from explicable.search import search
    >>> lamp = Atom("on", ())
    >>> switch = ActionSchema("switch", (), And(), (Effect(lamp),))
    >>> domain = Domain("room", frozenset(), {}, {}, (Predicate("on", ()),), (), (switch,))
    >>> task = ground(Problem("dark", domain, {}, (), lamp, {}))
    >>> scorer = scorer_of(task, lambda path, rest: max(len(path) + len(rest) - 1, 0))
    >>> search(task, "anytime", scorer=scorer, alpha=1.0).objective
    1.0
    """
    return _core.CallbackScorer(task.core, _Callbacks(task, count))


@dataclass(frozen=True, slots=True)
class _Callbacks:
    """What the core asks: a context is the path, as operators."""

    task: Task
    count: Count

    def root(self, state: bytes) -> tuple[int, ...]:  # noqa: ARG002 (the core's signature)
        return ()

    def extend(
        self,
        path: tuple[int, ...],
        operator: int,
        before: bytes,  # noqa: ARG002 (the core's signature)
        after: bytes,  # noqa: ARG002 (the core's signature)
    ) -> tuple[int, ...]:
        return (*path, operator)

    def score(
        self,
        path: tuple[int, ...],
        state: bytes,  # noqa: ARG002 (the core's signature)
        relaxed_plan: Sequence[int],
    ) -> tuple[float, float, int]:
        done, rest = self._actions(path), self._actions(relaxed_plan)
        return self.count(done, rest), 0.0, len(done) + len(rest)

    def closing_key(self, path: tuple[int, ...]) -> int:
        return hash(path) & (2**64 - 1)

    def _actions(self, operators: Sequence[int]) -> tuple[GroundAtom, ...]:
        return tuple(action for action in map(self.task.action, operators) if action)

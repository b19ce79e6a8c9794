"""Exact costs-to-go in one task, each found by A* once and remembered with the whole way."""

import math
from collections.abc import Sequence
from typing import Literal

from explicable import _core
from explicable.errors import ResourceError
from explicable.model.task import State, Task
from explicable.search.forward import search
from explicable.search.result import Outcome

Goal = tuple[int, ...]
"""Facts, by number."""

NO_STEP = -1


class CostsToGo:
    """What it costs from any state of a task to any goal; for those who ask for many, most of them near.

    Every state on an optimal way has its own optimal rest, so one search answers for all of them: whoever
    keeps to the ways expected hardly ever searches. The ways are those of ``search(task, "astar",
    heuristic="tour")``, and what is known of a state stays.

    Parameters
    ----------
    task
        The grounded task.
    most
        Where more states are known, all is forgotten before more is found out.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground
    >>> task = ground(encode(World(("@.*",))).composite)
    >>> ahead = CostsToGo(task)
    >>> ahead.cost(task.initial_state, task.goal)
    4
    >>> [task.action(operator)[0] for operator in ahead.way(task.initial_state, task.goal)][:2]
    ['move', 'move']
    """

    def __init__(self, task: Task, most: int = 100_000) -> None:
        self.task = task
        self._known = _core.CostsToGo(task.core, most)

    def cost(self, state: State, goal: Goal, by: int = NO_STEP) -> float:
        """Return the cost-to-go from a state, or from what an operator makes of it; infinite without a way.

        Raises
        ------
        ResourceError
            Here and below, if memory does not suffice to find it out.
        """
        known = self._known.cost(state, goal, by)
        if known is None:
            self._search(state, goal, by)
            known = self._known.cost(state, goal, by)
        return math.inf if known is None else known

    def first(self, state: State, goal: Goal, by: int = NO_STEP) -> int | None:
        """Return the operator with which a best way begins; None at the goal, or if there is no way."""
        known = self._known.first(state, goal, by)
        if known is None:
            self._search(state, goal, by)
            known = self._known.first(state, goal, by)
        return None if known in (None, NO_STEP) else known

    def way(self, state: State, goal: Goal, by: int = NO_STEP) -> Sequence[int] | None:
        """Return the operators of a best way; None if there is no way."""
        if self.cost(state, goal, by) == math.inf:
            return None
        known = self._known.way(state, goal, by)
        return self._search(state, goal, by) if known is None else known

    def _search(self, state: State, goal: Goal, by: int) -> tuple[int, ...] | None:
        """Find a way that takes long to find, and learn it."""
        start = state if by == NO_STEP else self.task.successor(state, by)
        # Mostly one thing is needed, for which h_max is as good as LM-cut and much cheaper.
        heuristic: Literal["lmcut", "hmax"] = "lmcut" if goal == self.task.goal else "hmax"
        result = search(self.task, "astar", initial_state=start, goal=goal, heuristic=heuristic)
        if result.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if result.outcome is Outcome.LIMIT:
            raise ResourceError(f"not enough memory for the exact cost-to-go in {self.task.problem.name}")
        self._known.learn(start, goal, result.operators)
        return result.operators

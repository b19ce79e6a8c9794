"""Exact costs-to-go in one task, each found by A* once and remembered with the whole way."""

import math
from typing import Literal, NamedTuple

from explicable.errors import ResourceError
from explicable.execution import remembering
from explicable.model.task import State, Task
from explicable.search import Outcome, Way, find_way, search

Goal = tuple[int, ...]


class _ToGo(NamedTuple):
    """What lies between a state and a goal, and the step to begin with."""

    cost: float
    operator: int | None = None  # none at the goal, nor where no way leads there
    after: State | None = None


class CostsToGo:
    """What it costs from any state of a task to any goal.

    Every state on an optimal way has its own optimal rest, so one search answers for all of them: whoever
    keeps to the ways expected hardly ever searches.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground
    >>> task = ground(encode(World(("@.*",))).composite)
    >>> ahead = CostsToGo(task)
    >>> ahead.cost(task.initial_state, task.goal), len(ahead.way(task.initial_state, task.goal))
    (4, 4)
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self._known: dict[tuple[State, Goal], _ToGo] = {}

    def cost(self, state: State, goal: Goal) -> float:
        """Return the cost-to-go; infinite if no way leads to the goal."""
        return self._from(state, goal).cost

    def first(self, state: State, goal: Goal) -> int | None:
        """Return the operator with which a best way begins; None at the goal, or if there is no way."""
        return self._from(state, goal).operator

    def way(self, state: State, goal: Goal) -> tuple[int, ...] | None:
        """Return the operators of a best way; None if there is no way."""
        way, ahead = [], self._from(state, goal)
        if ahead.cost == math.inf:
            return None
        while ahead.operator is not None and ahead.after is not None:
            way.append(ahead.operator)
            ahead = self._from(ahead.after, goal)
        return tuple(way)

    def _from(self, state: State, goal: Goal) -> _ToGo:
        return self._known.get((state, goal)) or self._explore(state, goal)

    def _explore(self, state: State, goal: Goal) -> _ToGo:
        known, cost = self._known, self.task.core.cost
        if len(known) >= remembering.MOST_REMEMBERED:
            known.clear()
        operators, states = find_way(self.task, state, goal) or self._search(state, goal)
        if not states:
            return known.setdefault((state, goal), _ToGo(math.inf))
        # From the goal back, and what is known stays: so whatever is known leads to the goal, at any moment
        # in which another thread may look.
        remaining, after = 0, states[-1]
        ahead = known.setdefault((after, goal), _ToGo(0))
        for operator, before in zip(reversed(operators), reversed(states[:-1]), strict=True):
            remaining += cost(operator)
            ahead = known.setdefault((before, goal), _ToGo(remaining, operator, after))
            after = before
        return ahead

    def _search(self, state: State, goal: Goal) -> Way:
        # A request mostly needs one thing, for which h_max is as good as LM-cut and much cheaper.
        heuristic: Literal["lmcut", "hmax"] = "lmcut" if goal == self.task.goal else "hmax"
        result = search(self.task, "astar", initial_state=state, goal=goal, heuristic=heuristic)
        if result.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if result.outcome is Outcome.LIMIT:
            raise ResourceError(f"not enough memory for the exact cost-to-go in {self.task.problem.name}")
        if result.operators is None:
            return Way((), ())
        states = [state]
        for operator in result.operators:
            states.append(self.task.successor(states[-1], operator))
        return Way(result.operators, states)

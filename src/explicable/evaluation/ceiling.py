"""The ceiling: the plan that participants would hold least against the robot, were their minds known.

No real robot can plan like that. It shows how much there is to gain at all: where even this plan is hardly
more explicable than FF's, no labeller and no planner can make it so.
"""

import heapq
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from explicable.errors import UsageError
from explicable.execution import Participant, Setting
from explicable.execution import mind as minds
from explicable.execution.mind import Mind
from explicable.labelling.traces import problem_checksum
from explicable.model.problem import GroundAtom
from explicable.model.task import State, Task

_Path = tuple[GroundAtom, "_Path"] | None
_Node = tuple[State, int, int]
"""A state, and the numbers of the mind that learns and of the one that does not."""


def plan_for_judges(
    setting: Setting, judges: Sequence[Participant], max_cost_increase: float = 0.05
) -> tuple[GroundAtom, ...]:
    """Return a plan with the fewest steps held against it, by expectation, that is at most so much dearer.

    Dijkstra's algorithm over states and minds, within the limit of cost. What a judge learns on the way is
    left to chance, so two minds go along: one that learns nothing, and one that learns whatever it can and
    forgets nothing; the mean of both counts, over all judges. Wrong answers are left out.

    Parameters
    ----------
    judges
        Of one family: they may differ in slack, temperature, learning, and so on, but not in their horizon.
    max_cost_increase
        Over the cheapest plan.

    Raises
    ------
    UsageError
        If there are no judges, their minds differ, or the problem has no plan.
    """
    if len({(judge.horizon, judge.initiative) for judge in judges}) != 1:
        raise UsageError("the judges must have one horizon")
    task = setting.truth.task
    to_go, start = _costs_to_go(_Place(problem_checksum(setting.problem), task)), task.initial_state
    if start not in to_go:
        raise UsageError("there is no plan")
    max_cost = math.floor(to_go[start] * (1 + max_cost_increase) + 1e-9)
    watcher = _Watcher(setting, judges)
    mind = watcher.number(Mind(setting.belief.task.initial_state))
    numbers = itertools.count()
    queue: list[tuple[float, int, int, _Node, _Path]] = [(0.0, 0, next(numbers), (start, mind, mind), None)]
    cheapest: dict[_Node, int] = {}  # of the ways by which a node was left
    while True:
        count, cost, _, node, path = heapq.heappop(queue)
        if cheapest.get(node, math.inf) <= cost:
            continue
        cheapest[node] = cost
        if to_go[node[0]] == 0 and task.is_goal(node[0]):
            return _actions(path)
        for operator, after in _steps(task, node[0]):
            action, price = task.action(operator), task.cost(operator)
            if cost + price + to_go.get(after, math.inf) <= max_cost:
                against, learnt, unlearnt = watcher.after(node, action, after)
                child = (after, learnt, unlearnt)
                if cheapest.get(child, math.inf) > cost + price:
                    entry = (count + against, cost + price, next(numbers), child, (action, path))
                    heapq.heappush(queue, entry)


class _Watcher:
    """What the judges make of each step, remembered; minds go by numbers, which are quicker to look up."""

    def __init__(self, setting: Setting, judges: Sequence[Participant]) -> None:
        self.setting, self.judges = setting, judges
        self.learner = replace(judges[0], learning=1.0, memory=1.0)
        self.chance = np.random.default_rng(0)  # leaves nothing open: the learner is sure to learn
        self._minds: list[Mind] = []
        self._numbers: dict[Mind, int] = {}
        self._known: dict[tuple[int, GroundAtom, State, bool], tuple[float, int]] = {}

    def number(self, mind: Mind) -> int:
        """Return a mind's number; equal minds have the same."""
        if mind not in self._numbers:
            self._numbers[mind] = len(self._minds)
            self._minds.append(mind)
        return self._numbers[mind]

    def after(self, node: _Node, action: GroundAtom, state: State) -> tuple[float, int, int]:
        """Return how many hold a step against the robot, as a share, and both minds after it."""
        before, learning, unlearning = node
        one, learnt = self._watch(learning, action, before, state, learns=True)
        other, unlearnt = self._watch(unlearning, action, before, state, learns=False)
        return (one + other) / 2, learnt, unlearnt

    def _watch(
        self, number: int, action: GroundAtom, before: State, state: State, *, learns: bool
    ) -> tuple[float, int]:
        key = (number, action, before, learns)
        if key not in self._known:
            mind, against = self._minds[number], 0.0
            if self.setting.problem.agent_of(action).kind == "robot":
                held = minds.regret(self.setting.belief, self.learner, mind, action)
                accepted = sum(minds.acceptance(judge, held) for judge in self.judges)
                against = 1.0 - accepted / len(self.judges)
                if learns and held > 0:
                    mind = minds.infer(self.setting, self.learner, mind, before, self.chance)
            then = minds.watch(self.setting, mind, action, before, state)
            # What was tried or worked out how plays no part in judging, and would keep equal minds apart.
            self._known[key] = against, self.number(Mind(then.state, then.requests))
        return self._known[key]


def _steps(task: Task, state: State) -> Iterator[tuple[int, State]]:
    """Yield the operators that are applicable, and where they lead; what only changes beliefs is no step."""
    for operator in task.applicable(state):
        action = task.action(operator)
        if action and " " not in action[0]:
            after = task.successor(state, operator)
            if after != state:
                yield operator, after


@dataclass(frozen=True, slots=True)
class _Place:
    """A task, known again by its problem's checksum whenever it has been grounded anew."""

    checksum: str
    task: Task = field(compare=False)


@lru_cache(maxsize=8)
def _costs_to_go(place: _Place) -> Mapping[State, int]:
    """Return what the goal costs from each state from which it can be reached.

    The last few tasks' are kept: trials that differ in nothing but participants plan for the same maps.
    """
    task = place.task
    states, numbers = [task.initial_state], {task.initial_state: 0}
    before: list[list[tuple[int, int]]] = [[]]
    for number, state in enumerate(states):  # which grows meanwhile
        for operator, after in _steps(task, state):
            if after not in numbers:
                numbers[after] = len(states)
                states.append(after)
                before.append([])
            before[numbers[after]].append((task.cost(operator), number))
    queue = [(0, number) for number, state in enumerate(states) if task.is_goal(state)]
    found: dict[int, int] = {}
    while queue:  # Dijkstra's algorithm, backwards
        cost, number = heapq.heappop(queue)
        if number not in found:
            found[number] = cost
            for price, other in before[number]:
                if other not in found:
                    heapq.heappush(queue, (cost + price, other))
    return {states[number]: cost for number, cost in found.items()}


def _actions(path: _Path) -> tuple[GroundAtom, ...]:
    actions = []
    while path is not None:
        actions.append(path[0])
        path = path[1]
    return tuple(reversed(actions))

"""The ceiling: the plan that participants would hold least against the robot, were their minds known.

No real robot can plan like that. It shows how much there is to gain at all: where even this plan is hardly
more explicable than FF's, no labeller and no planner can make it so.
"""

import heapq
import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from explicable.errors import UsageError
from explicable.execution import Participant, Setting
from explicable.execution import mind as minds
from explicable.execution.mind import Mind
from explicable.model.problem import GroundAtom
from explicable.model.task import State

_Steps = dict[State, list[tuple[GroundAtom, int, State]]]
_Path = tuple[GroundAtom, "_Path"] | None


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
    steps = _list_steps(setting)
    to_go = _costs_to_go(setting, steps)
    start = setting.truth.task.initial_state
    if start not in to_go:
        raise UsageError("there is no plan")
    max_cost = math.floor(to_go[start] * (1 + max_cost_increase) + 1e-9)
    watcher = _Watcher(setting, judges)
    mind = Mind(setting.belief.task.initial_state)
    numbers = itertools.count()
    queue: list[tuple[float, int, int, tuple[State, Mind, Mind], _Path]] = [
        (0.0, 0, next(numbers), (start, mind, mind), None)
    ]
    cheapest: dict[tuple[State, Mind, Mind], int] = {}  # of the ways by which a node was left
    while True:
        count, cost, _, node, path = heapq.heappop(queue)
        if cheapest.get(node, math.inf) <= cost:
            continue
        cheapest[node] = cost
        if to_go[node[0]] == 0 and setting.truth.task.is_goal(node[0]):
            return _actions(path)
        for action, price, after in steps[node[0]]:
            if cost + price + to_go.get(after, math.inf) <= max_cost:
                against, learnt, unlearnt = watcher.after(node, action, after)
                child = (after, learnt, unlearnt)
                if cheapest.get(child, math.inf) > cost + price:
                    entry = (count + against, cost + price, next(numbers), child, (action, path))
                    heapq.heappush(queue, entry)


class _Watcher:
    """What the judges make of each step, remembered."""

    def __init__(self, setting: Setting, judges: Sequence[Participant]) -> None:
        self.setting, self.judges = setting, judges
        self.learner = replace(judges[0], learning=1.0, memory=1.0)
        self.chance = np.random.default_rng(0)  # leaves nothing open: the learner is sure to learn
        self._known: dict[tuple[Mind, GroundAtom, State, bool], tuple[float, Mind]] = {}

    def after(
        self, node: tuple[State, Mind, Mind], action: GroundAtom, state: State
    ) -> tuple[float, Mind, Mind]:
        """Return how many hold a step against the robot, as a share, and both minds after it."""
        before, learning, unlearning = node
        one, learnt = self._watch(learning, action, before, state, learns=True)
        other, unlearnt = self._watch(unlearning, action, before, state, learns=False)
        return (one + other) / 2, learnt, unlearnt

    def _watch(
        self, mind: Mind, action: GroundAtom, before: State, state: State, *, learns: bool
    ) -> tuple[float, Mind]:
        key = (mind, action, before, learns)
        if key not in self._known:
            against = 0.0
            if self.setting.problem.agent_of(action).kind == "robot":
                held = minds.regret(self.setting.belief, self.learner, mind, action)
                accepted = sum(minds.acceptance(judge, held) for judge in self.judges)
                against = 1.0 - accepted / len(self.judges)
                if learns and held > 0:
                    mind = minds.infer(self.setting, self.learner, mind, before, self.chance)
            then = minds.watch(self.setting, mind, action, before, state)
            # What was tried or worked out how plays no part in judging, and would keep equal minds apart.
            self._known[key] = against, Mind(then.state, then.requests)
        return self._known[key]


def _list_steps(setting: Setting) -> _Steps:
    """List all states that can be reached, with the steps from each."""
    task = setting.truth.task
    actions = [task.action(operator) for operator in range(task.num_operators)]
    steps: _Steps = {}
    states = [task.initial_state]
    seen = set(states)
    for state in states:
        steps[state] = []
        for operator in task.applicable(state):
            action = actions[operator]
            after = task.successor(state, operator)
            if action and " " not in action[0] and after != state:  # what only changes beliefs is no step
                steps[state].append((action, task.cost(operator), after))
                if after not in seen:
                    seen.add(after)
                    states.append(after)
    return steps


def _costs_to_go(setting: Setting, steps: _Steps) -> dict[State, int]:
    before: dict[State, list[tuple[State, int]]] = {}
    for state, following in steps.items():
        for _, price, after in following:
            before.setdefault(after, []).append((state, price))
    goals = (state for state in steps if setting.truth.task.is_goal(state))
    return _distances(goals, lambda state: before.get(state, ()))


def _distances(
    starts: Iterable[State], edges: Callable[[State], Iterable[tuple[State, int]]]
) -> dict[State, int]:
    """Dijkstra's algorithm."""
    numbers = itertools.count()
    queue = [(0, next(numbers), state) for state in starts]
    found: dict[State, int] = {}
    while queue:
        distance, _, state = heapq.heappop(queue)
        if state not in found:
            found[state] = distance
            for other, price in edges(state):
                if other not in found:
                    heapq.heappush(queue, (distance + price, next(numbers), other))
    return found


def _actions(path: _Path) -> tuple[GroundAtom, ...]:
    actions = []
    while path is not None:
        actions.append(path[0])
        path = path[1]
    return tuple(reversed(actions))

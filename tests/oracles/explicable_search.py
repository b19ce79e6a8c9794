"""Eq. 4 by the book: labelled hill-climbing and best-first search; the best plan by enumeration."""

import heapq
import itertools
from collections import deque
from fractions import Fraction

from explicable import _core

INFINITY = float("inf")


def weighing(weights):
    """Explicability by weights of operators, each the probability that the step is inexplicable."""
    return lambda steps, _: 1 - Fraction(sum(weights[step] for step in steps)) / max(len(steps), 1)


def value(task, explicability, path, state):
    """Eq. 4; explicability is F of path # rp, of whose steps the first so many are the path."""
    answer = _core.relaxed_plan(task.core, state, task.goal)
    if answer is None:
        return INFINITY
    rp = tuple(answer[1])
    joined = path + rp
    return (1 - explicability(joined, len(path))) * len(joined) * len(rp) + len(rp)


def climb(task, explicability):
    """Enforced hill-climbing over helpful actions; None where it fails."""
    state, path = task.initial_state, ()
    if task.is_goal(state):
        return path
    best = value(task, explicability, path, state)
    if best == INFINITY:
        return None
    while True:
        seen = {state}
        queue = deque([(state, path)])
        found = None
        while queue and found is None:
            here, steps = queue.popleft()
            for step in _core.helpful_operators(task.core, here, task.goal):
                after = task.successor(here, step)
                if after in seen:
                    continue
                seen.add(after)
                longer = (*steps, step)
                if task.is_goal(after):
                    return longer
                h = value(task, explicability, longer, after)
                if h < best:
                    best, found = h, (after, longer)
                    break
                if h < INFINITY:
                    queue.append((after, longer))
        if found is None:
            return None
        state, path = found


def best_first(task, explicability):
    """Eager best-first search by f = g + h, ties by h, then by age; a state is looked at once."""
    ages = itertools.count()
    seen = {task.initial_state}
    h = value(task, explicability, (), task.initial_state)
    heap = [(h, h, next(ages), task.initial_state, (), 0)]
    while heap:
        f, _, _, state, path, cost = heapq.heappop(heap)
        if f == INFINITY:
            return None
        if task.is_goal(state):
            return path
        for step in _core.applicable_operators(task.core, state):
            after = task.successor(state, step)
            if after in seen:
                continue
            seen.add(after)
            longer, new_cost = (*path, step), cost + task.cost(step)
            h = value(task, explicability, longer, after)
            heapq.heappush(heap, (new_cost + h, h, next(ages), after, longer, new_cost))
    return None


def least_objective(task, penalty, max_steps):
    """min of cost + penalty(path) over all plans of up to `max_steps` steps."""
    best = INFINITY
    pending = [(task.initial_state, (), 0)]
    while pending:
        state, path, cost = pending.pop()
        if task.is_goal(state):
            best = min(best, cost + penalty(path))
        if len(path) < max_steps:
            pending += [
                (task.successor(state, step), (*path, step), cost + task.cost(step))
                for step in task.applicable(state)
            ]
    return best

"""Eq. 4 by the book: labelled hill-climbing and best-first search; the best plan by enumeration."""

import heapq
import itertools
from collections import deque

from explicable import _core

INFINITY = float("inf")


def value(task, weights, path, state):
    """h = (1 + c) * len(rp), c the weight of all steps of path # rp; with the state's helpful operators."""
    answer = _core.relaxed_plan(task.core, state, task.goal)
    if answer is None:
        return INFINITY
    relaxed_plan = answer[1]
    return (1.0 + sum(weights[step] for step in (*path, *relaxed_plan))) * len(relaxed_plan)


def climb(task, weights):
    """Enforced hill-climbing over helpful actions; None where it fails."""
    state, path = task.initial_state, ()
    if task.is_goal(state):
        return path
    best = value(task, weights, path, state)
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
                h = value(task, weights, longer, after)
                if h < best:
                    best, found = h, (after, longer)
                    break
                if h < INFINITY:
                    queue.append((after, longer))
        if found is None:
            return None
        state, path = found


def best_first(task, weights):
    """Eager best-first search by f = g + h, ties by h, then by age; a state is looked at once."""
    ages = itertools.count()
    seen = {task.initial_state}
    h = value(task, weights, (), task.initial_state)
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
            h = value(task, weights, longer, after)
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

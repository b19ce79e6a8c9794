"""Costs-to-go the slow, obvious way: Dijkstra over whole states, with nothing but a task's public methods."""

import heapq
import itertools
import math


def cheapest(task, state, reached, allowed):
    """Cost from `state` to the nearest state `reached`, by operators that are `allowed`; inf if none."""
    tie = itertools.count()
    queue, best = [(0, next(tie), state)], {state: 0}
    while queue:
        cost, _, here = heapq.heappop(queue)
        if cost > best[here]:
            continue
        if reached(here):
            return cost
        for operator in task.applicable(here):
            if allowed(operator):
                there, total = task.successor(here, operator), cost + task.cost(operator)
                if total < best.get(there, math.inf):
                    best[there] = total
                    heapq.heappush(queue, (total, next(tie), there))
    return math.inf

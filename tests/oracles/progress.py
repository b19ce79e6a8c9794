"""Progress of steps toward goals and requests, as docs/labelling.md tells it and as slowly as that takes."""

import itertools
import math


def used_up(task, operator):
    preconditions, deletes = set(task.core.preconditions(operator)), set(task.core.deletes(operator))
    return {task.fact(fact) for fact in preconditions & deletes or preconditions}


def added(task, operator):
    return {task.fact(fact) for fact in task.core.adds(operator)}


def needs(task, operator):
    return {task.fact(fact) for fact in task.core.preconditions(operator)}


def distances(task, zero, one):
    """Transitions from each fact to the target, by relaxation until nothing changes."""
    distance = dict.fromkeys(one, 1) | dict.fromkeys(zero, 0)
    edges = [
        (p, q)
        for o in range(task.num_operators)
        for p, q in itertools.product(used_up(task, o), added(task, o))
        if not (q in zero and q not in one)  # achievers' needs stand at 1 already
    ]
    changed = True
    while changed:
        changed = False
        for p, q in edges:
            if q in distance and distance[q] + 1 < distance.get(p, math.inf):
                distance[p] = distance[q] + 1
                changed = True
    return distance


def to_goal(task, goal):
    achievers = [o for o in range(task.num_operators) if goal in added(task, o)]
    return distances(task, {goal}, set().union(*(needs(task, o) for o in achievers)) - {goal})


def to_request(task, facts, is_human):
    fulfilling = [o for o in range(task.num_operators) if not is_human(task, o) and facts & needs(task, o)]
    return distances(task, set(), set().union(*(needs(task, o) for o in fulfilling)) - facts)


def judge(before, after):
    if before == math.inf:
        return "unconcerned" if after == math.inf else "nearer"
    if after == math.inf:
        return "no-way"
    regret = after + 1 - before
    return "shortcut" if regret < 0 else ("nearer", "no-nearer", "farther", "much-farther")[min(regret, 3)]


def least(facts, cost):
    return min((cost(fact) for fact in facts), default=math.inf)


def toward_request(team, operator, distance):
    task = team.task
    cost = lambda fact: distance.get(fact, math.inf)  # noqa: E731 (short)
    return judge(least(used_up(task, operator), cost), least(added(task, operator), cost))


def toward_goals(team, operator, by_goal, cost_of_order):
    """Judge a step by the best order of the goals: the way to the first, then the cost of the rest."""
    task = team.task

    def cost(fact):
        orders = itertools.permutations(by_goal)
        return min(by_goal[order[0]].get(fact, math.inf) + cost_of_order(order) for order in orders)

    return judge(least(used_up(task, operator), cost), least(added(task, operator), cost))

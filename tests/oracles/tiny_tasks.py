"""Propositional tasks of a few facts, and slow obvious answers to what the searches are asked."""

import heapq
import itertools
from dataclasses import dataclass

from explicable.model.problem import ActionSchema, And, Atom, Domain, Effect, Predicate, Problem

Facts = frozenset[int]
INFINITY = float("inf")


@dataclass(frozen=True)
class TinyEffect:
    condition: Facts
    adds: Facts
    deletes: Facts


@dataclass(frozen=True)
class TinyOperator:
    precondition: Facts
    effects: tuple[TinyEffect, ...]  # the first has no condition
    cost: int

    def apply(self, state: Facts) -> Facts:
        fired = [effect for effect in self.effects if effect.condition <= state]
        deleted = frozenset().union(*(effect.deletes for effect in fired))
        return (state - deleted).union(*(effect.adds for effect in fired))


@dataclass(frozen=True)
class TinyTask:
    num_facts: int
    operators: tuple[TinyOperator, ...]
    initial: Facts
    goal: Facts

    def successors(self, state):
        for index, operator in enumerate(self.operators):
            if operator.precondition <= state:
                yield index, operator.apply(state)

    def problem(self) -> Problem:
        """The same, lifted: predicates ``f0`` ... and actions ``a0`` ... without parameters."""

        def atoms(facts):
            return tuple(Atom(f"f{fact}", ()) for fact in sorted(facts))

        schemas = []
        for index, operator in enumerate(self.operators):
            effects = [
                Effect(atom, positive, And(atoms(effect.condition)))
                for effect in operator.effects
                for positive, facts in ((False, effect.deletes - effect.adds), (True, effect.adds))
                for atom in atoms(facts)
            ]
            schemas.append(
                ActionSchema(
                    f"a{index}", (), And(atoms(operator.precondition)), tuple(effects), (operator.cost,)
                )
            )
        predicates = tuple(Predicate(f"f{fact}", ()) for fact in range(self.num_facts))
        requirements = frozenset((":strips", ":conditional-effects", ":action-costs"))
        domain = Domain("tiny", requirements, {}, {}, predicates, (), tuple(schemas))
        init = tuple((f"f{fact}",) for fact in sorted(self.initial))
        return Problem("tiny", domain, {}, init, And(atoms(self.goal)), {}, minimize_cost=True)


def optimal_cost(task: TinyTask) -> float:
    """Dijkstra's algorithm over the whole state space; infinite if there is no plan."""
    best = {task.initial: 0}
    counter = itertools.count()
    heap = [(0, next(counter), task.initial)]
    while heap:
        cost, _, state = heapq.heappop(heap)
        if cost > best[state]:
            continue
        if task.goal <= state:
            return cost
        for index, successor in task.successors(state):
            new_cost = cost + task.operators[index].cost
            if new_cost < best.get(successor, INFINITY):
                best[successor] = new_cost
                heapq.heappush(heap, (new_cost, next(counter), successor))
    return INFINITY


def reachable_states(task: TinyTask) -> list[Facts]:
    found = {task.initial: None}
    pending = [task.initial]
    while pending:
        for _, successor in task.successors(pending.pop()):
            if successor not in found:
                found[successor] = None
                pending.append(successor)
    return list(found)


def relaxed_cost(task: TinyTask, state: Facts, combine, cost_of) -> float:
    """h_add (combine = sum) or h_max (combine = max) of the goal, by plain iteration to the fixpoint."""
    value = {fact: 0 if fact in state else INFINITY for fact in range(task.num_facts)}
    changed = True
    while changed:
        changed = False
        for operator in task.operators:
            for effect in operator.effects:
                needed = operator.precondition | effect.condition
                cost = cost_of(operator) + combine([0, *(value[fact] for fact in needed)])
                for fact in effect.adds:
                    if cost < value[fact]:
                        value[fact] = cost
                        changed = True
    return combine([0, *(value[fact] for fact in task.goal)])


def executes_relaxed(task: TinyTask, state: Facts, plan) -> bool:
    """Whether the plan, in its order and with nothing ever deleted, is executable and reaches the goal."""
    reached = set(state)
    for index in plan:
        operator = task.operators[index]
        if not operator.precondition <= reached:
            return False
        fired = [effect for effect in operator.effects if effect.condition <= reached]
        reached.update(*(effect.adds for effect in fired))
    return task.goal <= reached


def goal_distances(task: TinyTask) -> dict[Facts, float]:
    """Cost of the cheapest plan from every reachable state, by value iteration."""
    states = reachable_states(task)
    distances = {state: 0 if task.goal <= state else INFINITY for state in states}
    changed = True
    while changed:
        changed = False
        for state in states:
            for index, successor in task.successors(state):
                distance = task.operators[index].cost + distances[successor]
                if distance < distances[state]:
                    distances[state] = distance
                    changed = True
    return distances

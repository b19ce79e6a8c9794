"""Successors, relaxed plans and lower bounds against slow oracles, in reachable states of random tasks."""

from itertools import islice

from hypothesis import given
from tiny_strategies import tiny_tasks

from explicable import _core
from explicable.model.grounding import ground
from oracles.tiny_tasks import (
    INFINITY,
    executes_relaxed,
    goal_distances,
    reachable_states,
    relaxed_cost,
)


class Pair:
    """A tiny task beside its ground version."""

    def __init__(self, tiny):
        self.tiny = tiny
        self.task = ground(tiny.problem())

    def states(self, limit=20):
        for state in islice(reachable_states(self.tiny), limit):
            yield state, self.task.state_of((f"f{fact}",) for fact in state)

    def index(self, operator):
        return int(self.task.action(operator)[0][1:])

    def indices(self, operators):
        return [self.index(operator) for operator in operators]


@given(tiny_tasks())
def test_successor_generator_finds_all_applicable_operators(tiny):
    pair = Pair(tiny)
    for state, packed in pair.states():
        found = _core.applicable_operators(pair.task.core, packed)
        possible = {index for index, _ in tiny.successors(state)}
        assert sorted(found) == pair.task.applicable(packed)
        # The grounder leaves out operators without effect.
        assert set(pair.indices(found)) <= possible
        assert all(tiny.operators[i].apply(state) == state for i in possible - set(pair.indices(found)))


@given(tiny_tasks())
def test_relaxed_plan_reaches_the_goal_and_h_add_equals_the_fixpoint(tiny):
    pair = Pair(tiny)
    for state, packed in pair.states():
        expected = relaxed_cost(tiny, state, sum, lambda _: 1)
        if not pair.task.goal_reachable:
            assert expected == INFINITY
            continue
        answer = _core.relaxed_plan(pair.task.core, packed, pair.task.goal)
        if answer is None:
            assert expected == INFINITY
        else:
            h_add, plan = answer
            assert h_add == expected
            assert executes_relaxed(tiny, state, pair.indices(plan))
            assert len(plan) <= h_add
            if any(len(operator.effects) > 1 for operator in tiny.operators):
                continue  # an operator may be in the plan for an effect whose condition is not met yet
            helpful = _core.helpful_operators(pair.task.core, packed, pair.task.goal)
            assert set(plan) & set(pair.task.applicable(packed)) <= set(helpful)


@given(tiny_tasks())
def test_lower_bounds_are_admissible_and_h_max_equals_the_fixpoint(tiny):
    pair = Pair(tiny)
    if not pair.task.goal_reachable:
        return
    distances = goal_distances(tiny)
    for state, packed in pair.states():
        values = {
            name: _core.heuristic_value(pair.task.core, packed, pair.task.goal, name)
            for name in ("blind", "hmax", "lmcut", "tour")
        }
        assert values["hmax"] == relaxed_cost(tiny, state, max, lambda operator: operator.cost)
        assert values["hmax"] <= values["lmcut"] <= distances[state]
        assert max(values["blind"], values["tour"]) <= distances[state]

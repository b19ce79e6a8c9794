"""Schedules, judged by validators that were not written here."""

from fractions import Fraction

import numpy as np
import pytest
from unified_planning.engines import SequentialPlanValidator, ValidationResultStatus
from unified_planning.engines.plan_validator import TimeTriggeredPlanValidator
from unified_planning.plans import TimeTriggeredPlan

from explicable.first_response import encode, generate
from explicable.model.durations import Durations
from explicable.model.grounding import ground
from explicable.model.schedule import make_schedule
from explicable.pddl.unified_planning import (
    from_peer_plan,
    to_peer_partial_order,
    to_peer_problem,
    to_peer_temporal_problem,
    to_peer_time_triggered,
)
from explicable.search import search

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning:unified_planning")
DURATIONS = Durations(schemas={"move": 2.0, "remove-obstacle": 5.5, "command": 0.25})


def schedule_of(semantics):
    world = generate(np.random.default_rng(3), height=4, width=4, num_marks=2, num_robots=2)
    problem = encode(world, semantics, num_people=2)
    task = ground(problem.composite)
    actions = tuple(map(task.action, search(task).operators))
    return problem.composite, make_schedule(problem, task, actions, DURATIONS)


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
def test_all_orders_of_the_partial_order_plan_are_valid(semantics):
    problem, schedule = schedule_of(semantics)
    theirs = to_peer_problem(problem)
    plan = to_peer_partial_order(schedule, theirs)
    assert sorted(from_peer_plan(plan)) == sorted(schedule.actions)
    with SequentialPlanValidator() as validator:
        for number, order in enumerate(plan.all_sequential_plans()):
            assert validator.validate(theirs, order).status == ValidationResultStatus.VALID
            if number == 5:
                break


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
def test_the_time_triggered_plan_is_valid_and_not_a_moment_sooner(semantics):
    problem, schedule = schedule_of(semantics)
    theirs = to_peer_temporal_problem(problem, DURATIONS)
    plan = to_peer_time_triggered(schedule, theirs)
    assert sorted(from_peer_plan(plan)) == sorted(schedule.actions)
    with TimeTriggeredPlanValidator() as validator:
        assert validator.validate(theirs, plan).status == ValidationResultStatus.VALID
        hasty = [(start * Fraction(9, 10), *rest) for start, *rest in plan.timed_actions]
        status = validator.validate(theirs, TimeTriggeredPlan(hasty, theirs.environment)).status
        assert status == ValidationResultStatus.INVALID

import math
from contextlib import contextmanager

import pytest
from rigs import FAILS, HANGS, STEPS, WORLD

from explicable.execution.robots import Blocked, Finished, Order, SimulatedRobot
from explicable.execution.robots.conformance import Rig, check
from explicable.execution.robots.unified_planning import UnifiedPlanningWorld
from explicable.first_response import builtin_maps, encode
from explicable.model.grounding import ground
from explicable.pddl.unified_planning import from_peer_plan, to_peer_action, to_peer_problem
from explicable.search import search


def test_a_robot_in_a_world_of_unified_planning_conforms():
    problem = encode(WORLD).composite

    @contextmanager
    def rig():
        robot = SimulatedRobot(
            "r1",
            UnifiedPlanningWorld(problem),
            duration=lambda action: math.inf if action == HANGS else 0.0,
            fault=lambda action: "wheel stuck" if action == FAILS else None,
        )
        yield Rig(robot, **STEPS)

    assert check(rig) == ()


@pytest.mark.filterwarnings("ignore::DeprecationWarning:unified_planning")
def test_an_executable_plan_of_theirs_is_carried_out_to_the_goal():
    from unified_planning.plans import SequentialPlan

    problem = encode(builtin_maps()["training-01"], "exclusive").composite
    task = ground(problem)
    theirs = to_peer_problem(problem)
    actions = tuple(map(task.action, search(task).operators))
    plan = SequentialPlan([to_peer_action(theirs, action) for action in actions], theirs.environment)
    world = UnifiedPlanningWorld(problem)
    robot = SimulatedRobot("r1", world)
    assert from_peer_plan(plan) == actions
    for number, action in enumerate(from_peer_plan(plan), start=1):
        assert not world.is_goal
        robot.send(Order(number, action))
        assert robot.poll() == Finished(number)
    assert world.is_goal
    robot.send(Order(1000, actions[0]))
    assert isinstance(robot.poll(), Blocked)

"""Plans followed over maps."""

import pytest

from explicable.errors import PlanError
from explicable.first_response.map_file import parse_map
from explicable.first_response.routes import Command, trace_routes

WORLD = parse_map("@.*\n.x@")
OUT = ("move", "r1", "c-0-0", "c-0-1")
BACK = ("move", "r1", "c-0-1", "c-0-0")


def test_passages_of_the_same_way_get_lanes_of_their_own():
    passages = trace_routes(WORLD, [OUT, BACK, OUT]).passages
    assert [(passage.step, passage.lane) for passage in passages] == [(0, 0), (1, 0), (2, 1)]


def test_a_command_stands_where_the_robot_is_that_will_visit():
    command = ("command", "person", "c-0-2")
    visit = [("move", "r2", "c-1-2", "c-0-2"), ("visit-room", "r2", "c-0-2")]
    assert trace_routes(WORLD, [command]).commands == (Command(0, (0, 0), (0, 2)),)
    assert trace_routes(WORLD, [command, *visit]).commands == (Command(0, (1, 2), (0, 2)),)
    assert [visit.step for visit in trace_routes(WORLD, visit).visits] == [1]


@pytest.mark.parametrize(
    ("action", "reason"),
    [
        (BACK, "not a way from where the robot is"),
        (("move", "r1", "c-0-0", "c-0-2"), "not a way"),
        (("move", "r1", "c-0-0", "c-9-9"), "leaves the map"),
        (("move", "r1", "c-0-0", "kitchen"), "names no cell: 'kitchen'"),
        (("move", "r9", "c-0-0", "c-0-1"), "not a step of this map's team"),
        (("visit-room", "r1", "c-0-2"), "the robot is not in"),
        (("command", "person", "c-0-1"), "no marked room"),
        (("dance", "r1"), "not a step"),
        (("move",), "not a step"),
    ],
)
def test_steps_that_do_not_fit_the_map_are_refused_by_number(action, reason):
    with pytest.raises(PlanError, match="step 3 .*" + reason):
        trace_routes(WORLD, [OUT, BACK, action])

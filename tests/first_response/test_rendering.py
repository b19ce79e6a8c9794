"""Pictures: well-formed whatever is in them, complete, and the same in grey."""

import itertools
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.first_response.generator import generate
from explicable.first_response.picture_key import key_entries
from explicable.first_response.rendering import render
from explicable.first_response.world import World, cell_name, parse_map, shortest_path
from explicable.model.plan import JointPlan, Step

SVG = "{http://www.w3.org/2000/svg}"


def commanded_plan(world):
    """Each room is commanded in turn; the robot takes a shortest way."""
    actions, cell = [], world.robots[0]
    for room in world.marks:
        actions.append(("command", "person", cell_name(room)))
        way = shortest_path(world, cell, room)
        actions += [("move", "r1", cell_name(a), cell_name(b)) for a, b in itertools.pairwise(way)]
        actions.append(("visit-room", "r1", cell_name(room)))
        cell = room
    return actions


def captions(svg):
    return [title.text for title in ET.fromstring(svg).iter(f"{SVG}title")]  # noqa: S314


@given(st.integers(0, 999), st.text(), st.sampled_from(["robot", "human"]), st.booleans(), st.data())
def test_any_plan_labels_and_title_give_a_well_formed_picture(seed, title, view, key, data):
    world = generate(np.random.default_rng(seed))
    plan = commanded_plan(world)
    labels = data.draw(st.lists(st.sampled_from([True, False, None]), min_size=len(plan), max_size=len(plan)))
    svg = render(world, view, plan, labels, title=title, key=key)
    heading, *signs = captions(svg)
    assert (
        heading == title or len(heading) == len(title) or not title
    )  # characters unknown to XML are replaced
    moves = [caption for caption in signs if "(move" in caption]
    assert len(moves) == sum(action[0] == "move" for action in plan)
    doubted = sum(label is False for action, label in zip(plan, labels, strict=True) if action[0] == "move")
    assert sum("inexplicable" in caption for caption in moves) == doubted
    for hostile in ("<script", " id=", " href="):
        assert hostile not in svg.lower()


def test_only_the_robot_sees_hidden_obstacles():
    hidden, plain = parse_map("@x.\n..*"), parse_map("@..\n..*")
    assert render(hidden, "human") == render(plain, "human")
    assert render(hidden, "robot") != render(plain, "robot").replace("0 hidden", "1 hidden")


def test_inexplicable_steps_differ_in_more_than_colour():
    world = World(("@*",))
    plan = [("move", "r1", "c-0-0", "c-0-1"), ("visit-room", "r1", "c-0-1")]
    assert "stroke-dasharray" not in render(world, plan=plan, labels=[True, None])
    assert "stroke-dasharray" in render(world, plan=plan, labels=[False, None])
    assert "stroke-dasharray" in render(world, plan=plan, labels=[True, False])  # the room's ring
    shaded = render(world, plan=plan, probabilities=[0.25, 1.0])
    assert "explicable with probability 0.25" in shaded
    assert "stroke-dasharray" in shaded


def test_joint_plans_are_drawn_as_their_actions():
    world = World(("@*",))
    actions = [
        ("command", "person", "c-0-1"),
        ("move", "r1", "c-0-0", "c-0-1"),
        ("visit-room", "r1", "c-0-1"),
    ]
    plan = JointPlan(tuple(Step(action[1], action) for action in actions), cost=3)
    assert render(world, plan=plan) == render(world, plan=actions)


@pytest.mark.parametrize("name", ["labels", "probabilities"])
def test_one_label_or_probability_a_step(name):
    with pytest.raises(UsageError, match="2 steps"):
        render(World(("@*",)), plan=[("command", "person", "c-0-1")] * 2, **{name: [1.0]})


def test_views_are_the_robots_and_the_humans():
    with pytest.raises(UsageError, match="robot or human, not by 'bird'"):
        render(World(("@*",)), "bird")


def test_large_maps_and_teams_stay_of_sensible_size():
    world = generate(np.random.default_rng(0), height=120, width=120, num_marks=30, num_robots=3)
    svg = render(world, "robot", key=True)
    root = ET.fromstring(svg)  # noqa: S314
    assert float(root.get("width")) <= 1600
    assert len(svg) < 500_000
    assert {"r1", "r2", "r3", "room AD, " + cell_name(world.marks[29])} <= set(captions(svg))


def test_the_key_is_under_the_picture_or_apart():
    world = World(("@x.", "..*"))
    inside = [text.text for text in ET.fromstring(render(world, "robot", key=True)).iter(f"{SVG}text")]  # noqa: S314
    apart = {meaning: ET.fromstring(sign) for sign, meaning in key_entries("robot")}  # noqa: S314
    assert {"marked room", "breakable obstacle", "hidden obstacle"} <= set(inside) & set(apart)
    assert "inexplicable step" in apart
    assert "hidden obstacle" not in {meaning for _, meaning in key_entries("human")}

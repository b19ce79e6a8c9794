"""Pictures: well-formed whatever is in them, complete, and the same in grey."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.first_response.generator import generate
from explicable.first_response.map_file import parse_map
from explicable.first_response.picture_key import key_entries
from explicable.first_response.rendering import render
from explicable.first_response.world import World, cell_name
from explicable.model.plan import JointPlan, Step
from oracles.first_response import commanded_plan, worlds

SVG = "{http://www.w3.org/2000/svg}"


def captions(svg):
    return [title.text for title in ET.fromstring(svg).iter(f"{SVG}title")]


@given(worlds(), st.text(), st.sampled_from(["robot", "human"]), st.booleans(), st.data())
def test_any_plan_labels_and_title_give_a_well_formed_picture(world, title, view, key, data):
    plan = commanded_plan(world, view)
    labels = data.draw(st.lists(st.sampled_from([True, False, None]), min_size=len(plan), max_size=len(plan)))
    svg = render(world, view, plan, labels, title=title, key=key)
    heading, *signs = captions(svg)
    assert (
        heading == title or len(heading) == len(title) or not title
    )  # characters unknown to XML are replaced
    moves = [caption for caption in signs if "(move" in caption or "(remove" in caption]
    assert len(moves) == sum(len(action) == 4 for action in plan)
    doubted = sum(label is False for action, label in zip(plan, labels, strict=True) if len(action) == 4)
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


@given(worlds(), st.sampled_from([0.25, 1.0]))
def test_a_plan_that_plays_itself_shows_every_step_in_time(world, step_s):
    plan = commanded_plan(world)
    root = ET.fromstring(render(world, "robot", plan, step_s=step_s))
    animations = [*root.iter(f"{SVG}animate"), *root.iter(f"{SVG}animateTransform")]
    assert {animation.get("dur") for animation in animations} == {f"{(len(plan) + 4) * step_s:g}s"}
    for animation in animations:
        times = [float(time) for time in animation.get("keyTimes").split(";")]
        assert len(times) == len(animation.get("values").split(";"))
        assert times == sorted(times)
        assert times[0] == 0
        assert times[-1] <= 1
    assert "<animate" not in render(world, "robot", plan)


@pytest.mark.parametrize("step_s", [-1, float("nan"), float("inf")])
def test_times_that_cannot_be_are_refused(step_s):
    with pytest.raises(UsageError, match="cannot take"):
        render(World(("@*",)), step_s=step_s)


def test_large_maps_and_teams_stay_of_sensible_size():
    world = generate(np.random.default_rng(0), height=64, width=64, num_marks=30, num_robots=3)
    svg = render(world, "robot", key=True)
    root = ET.fromstring(svg)
    assert float(root.get("width")) <= 1600
    assert len(svg) < 500_000
    assert {"r1", "r2", "r3", "room AD, " + cell_name(world.marks[29])} <= set(captions(svg))


def test_the_key_is_under_the_picture_or_apart():
    world = World(("@x.", "..*"))
    inside = [text.text for text in ET.fromstring(render(world, "robot", key=True)).iter(f"{SVG}text")]
    apart = {meaning: ET.fromstring(sign) for sign, meaning in key_entries("robot")}
    assert {"marked room", "breakable obstacle", "hidden obstacle"} <= set(inside) & set(apart)
    assert "inexplicable step" in apart
    assert "hidden obstacle" not in {meaning for _, meaning in key_entries("human")}


def test_a_map_shows_itself_in_a_notebook_as_the_robot_sees_it():
    world = World(("@x*", "..."))
    assert world._repr_svg_() == render(world, "robot") != render(world, "human")

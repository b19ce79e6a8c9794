"""Generated maps: what they promise, and that the built-in ones are what their seeds give."""

from importlib import resources

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.first_response.builtin import builtin_maps, generate_builtin
from explicable.first_response.generator import generate
from explicable.first_response.map_file import format_map, parse_map
from explicable.first_response.world import distances


def inner(world):
    return [row[1:-1] for row in world.rows[1:-1]]


@given(st.integers(0, 2**32))
@settings(max_examples=40)
def test_maps_keep_the_counts_of_the_study(seed):
    world = generate(np.random.default_rng(seed))
    count = "".join(inner(world)).count
    assert (world.height, world.width, len(world.marks), len(world.robots)) == (8, 8, 4, 1)
    assert 2 <= count("#") <= 4
    assert 1 <= count("o") <= 4
    assert 5 <= count("x") <= 8
    stops = (*world.robots, *world.marks)
    longer = [
        distances(world, start)[end] > distances(world, start, view="human")[end]
        for start in stops
        for end in stops
    ]
    assert any(longer)


@given(
    st.integers(0, 99),
    st.integers(1, 9),
    st.integers(1, 9),
    st.integers(1, 4),
    st.integers(1, 3),
    st.booleans(),
)
@settings(max_examples=40)
def test_any_size_gives_a_map_or_a_refusal(seed, height, width, num_marks, num_robots, border):
    options = {"height": height, "width": width, "num_marks": num_marks, "num_robots": num_robots}
    try:
        world = generate(np.random.default_rng(seed), **options, border=border)
    except UsageError:
        assert height * width < 3 * (num_marks + num_robots)  # only where there is hardly room
        return
    assert len(world.marks) == num_marks
    assert len(world.robots) == num_robots
    assert parse_map(format_map(world)) == world


def test_large_maps_and_exact_counts():
    world = generate(
        np.random.default_rng(0),
        height=60,
        width=40,
        num_marks=10,
        num_walls=7,
        num_obstacles=9,
        num_hidden=300,
    )
    count = "".join(inner(world)).count
    assert [count(character) for character in "#ox*"] == [7, 9, 300, 10]


@pytest.mark.parametrize(
    "options", [{"height": 0}, {"width": 999}, {"num_marks": 0}, {"num_hidden": -1}, {"num_walls": 40}]
)
def test_impossible_maps_are_refused(options):
    with pytest.raises(UsageError):
        generate(np.random.default_rng(0), **options)


@pytest.mark.parametrize(("kind", "number"), [("training", 16), ("test", 4)])
def test_built_in_maps_are_byte_for_byte_what_their_seeds_give(kind, number):
    made = generate_builtin(kind)
    folder = resources.files("explicable.first_response") / "maps"
    assert list(builtin_maps(kind)) == list(made)
    assert len(made) == number
    for name, world in made.items():
        assert (folder / f"{name}.map").read_bytes() == format_map(world).encode()

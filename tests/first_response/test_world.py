"""Maps: what loads, what is refused and how, and distances."""

import contextlib
import itertools
import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from explicable.errors import MapError
from explicable.first_response.map_file import format_map, parse_map, read_map
from explicable.first_response.world import World, cell_at, cell_name, distances, shortest_path
from oracles.first_response import worlds

PLAN = ("#.@o", "..x*", "*...")


@given(worlds(), st.sampled_from(["\n", "\r\n", "\r"]), st.booleans(), st.integers(0, 2), st.booleans())
def test_whatever_an_editor_makes_of_a_map_loads_as_the_same_world(world, newline, bom, num_blank, last):
    lines = format_map(world).splitlines()
    lines = ["", "; drawn by hand", *lines, "; the end", *[""] * num_blank]
    text = ("\ufeff" if bom else "") + newline.join(lines) + (newline if last else "  ")
    assert parse_map(text) == world


@given(st.text(st.sampled_from("#.*ox@;: \n\r\té\0\u2028"), max_size=60))
@example("@*\n\n..")
def test_any_text_is_a_map_or_an_error_with_its_place(text):
    try:
        assert (world := parse_map(text)) == parse_map(format_map(world))
    except MapError as error:
        refusal = error
    else:
        return
    assert refusal.line is None or 1 <= refusal.line <= len(re.split("\r\n|\r|\n", text))


@given(st.binary(max_size=40))
def test_any_file_is_a_map_or_an_error(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("maps") / "any.map"
    path.write_bytes(content)
    with contextlib.suppress(MapError):
        read_map(path)


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("", (None, None), "empty"),
        ("; only: talk\n", (None, None), "empty"),
        ("; a\n@.*\n..\n", (3, None), "2 cells, the first row has 3"),
        ("@.*\n\n...\n", (2, None), "blank line"),
        ("@.*\n.é.\n", (2, 2), r"U\+00E9"),
        ("@.*\n. .\n", (2, 2), r"' ' \(U\+0020\)"),
        ("..*\n", (None, None), "no robot"),
        ("..@\n", (None, None), "no marked room"),
        ("; a\n@*x\n; b\n##*\n", (4, 3), "c-1-2 cannot be reached"),
        ("@*" + "." * 999, (1, 1001), "more than 1000 cells"),
        ("@\n*\n" + ".\n" * 999, (1001, None), "more than 1000 rows"),
    ],
)
def test_a_damaged_map_is_refused_with_its_place(text, place, words):
    with pytest.raises(MapError, match=words) as caught:
        parse_map(text, "bad.map")
    assert (caught.value.line, caught.value.column) == place


def test_text_in_another_encoding_is_refused_with_its_line(tmp_path):
    path = tmp_path / "latin.map"
    path.write_bytes("; caf\n; café\n@*\n".encode("latin-1"))
    with pytest.raises(MapError, match=r"latin\.map:2: not UTF-8"):
        read_map(path)


def test_cells_are_sorted_by_kind_in_reading_order():
    world = World(PLAN)
    assert (world.robots, world.marks) == (((0, 2),), ((1, 3), (2, 0)))
    assert (world.walls, world.obstacles, world.hidden) == ({(0, 0)}, {(0, 3)}, {(1, 2)})
    assert cell_at(cell_name((12, 3))) == (12, 3)


@given(worlds(), st.sampled_from(["robot", "human"]))
def test_distances_are_those_of_floyd_and_warshall(world, view):
    cells = [
        cell
        for cell in itertools.product(range(world.height), range(world.width))
        if cell not in world.blocked(view)
    ]
    far = len(cells) + 1
    table = {
        (a, b): 0 if a == b else 1 if abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1 else far
        for a, b in itertools.product(cells, cells)
    }
    for via, a, b in itertools.product(cells, cells, cells):
        table[a, b] = min(table[a, b], table[a, via] + table[via, b])
    for start in (*world.robots, *world.marks):
        reached = {cell: table[start, cell] for cell in cells if table[start, cell] < far}
        assert distances(world, start, view=view) == reached
        for end in world.marks:
            path = shortest_path(world, start, end, view)
            assert (path and len(path) - 1) == reached.get(end)

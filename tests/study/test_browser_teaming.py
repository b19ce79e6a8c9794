"""Live teaming at a real browser: the robot acts by joint plans; a person answers and orders by mouse."""

import json

import pytest
from browser import PATIENCE_MS, begin, by_mouse, examine, follow, play, until, view_of
from studies import rows, write_study

from explicable.study import schema as tables
from explicable.study.serving import Server

PLAY = """
mode = "teaming"
labeller = "labeller.json"
planning_s = 10.0
semantics = "{semantics}"
alpha = {alpha}
"""
TASK = """
[[task]]
name = "one"
map = "one.map"
"""


def steps_of(folder, task):
    (assignment,) = (row for row in rows(folder, tables.ASSIGNMENTS) if row.task == task)
    assert assignment.status == "done"
    steps = sorted((row.number, row) for row in rows(folder, tables.STEPS) if row.assignment == assignment.id)
    labels = {
        row.number: row.explicable for row in rows(folder, tables.LABELS) if row.assignment == assignment.id
    }
    assert labels.keys() == {number for number, step in steps if step.agent == "r1"}
    return [step.operator for _, step in steps]


@pytest.mark.parametrize("hurries", [False, True])
def test_a_game_of_live_teaming_by_mouse_to_its_end(browser, tmp_path, labeller, hurries):
    # In the practice of the one that hurries, the robot goes to the room and then waits there for the order.
    terms = {"semantics": "persistent", "alpha": 0.0} if hurries else {"semantics": "exclusive", "alpha": 1.0}
    folder = write_study(tmp_path / "study", play=PLAY.format(**terms), tasks=TASK)
    (folder / "labeller.json").write_bytes(labeller.read_bytes())
    with Server(folder, port=0).in_background() as link:
        context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
        context.set_default_timeout(PATIENCE_MS)
        page = context.new_page()
        begin(page, link)
        play(page, *by_mouse(page))
        follow(page, "#finished a")
        page.check("input[value=before]")
        follow(page, "main button")
        assert view_of(page)["phase"] == "waiting"
        examine(page)
        page.click("[data-object=c-0-2]")
        until(page, "view.phase === 'question'")  # the robot acts
        page.click("[data-room=c-2-3]")  # and is told of another room meanwhile
        until(page, "!pending && view.commands.some(c => c.object === 'c-2-3' && c.is_present)")
        page.reload()
        play(page, *by_mouse(page))
        examine(page)
        follow(page, "#finished a")
        page.check("input[value='7']", force=True)
        follow(page, "main button")
        assert page.inner_text(".code")
        context.close()
    steps = steps_of(folder, "one")
    visits = [step for step in steps if step.startswith("(visit-room")]
    assert sorted(visits) == ["(visit-room r1 c-0-2)", "(visit-room r1 c-2-3)"]
    if not hurries:
        assert visits[0] == "(visit-room r1 c-2-3)"  # the last order holds: it has planned anew
    orders = [json.loads(row.data) for row in rows(folder, tables.EVENTS) if row.kind == "commanded"]
    assert all((order["expected"] or "(command person").startswith("(command person") for order in orders)
    assert any(order["expected"] for order in orders)

"""The picture of a schedule: what stands on its bars."""

import xml.etree.ElementTree as ET
from pathlib import Path

from explicable.model.grounding import ground
from explicable.model.schedule import make_schedule
from explicable.pddl import read_team_problem
from explicable.planning.gantt import draw_schedule
from explicable.search import search

WAREHOUSE = Path(__file__).parents[2] / "examples" / "warehouse"
SVG = "{http://www.w3.org/2000/svg}"


def test_bars_tell_apart_the_steps_of_one_schema():
    names = ("domain", "problem", "human-domain", "human-problem")
    problem = read_team_problem(*(WAREHOUSE / f"{name}.pddl" for name in names))
    task = ground(problem.composite)
    found = search(task)
    schedule = make_schedule(problem, task, [task.action(operator) for operator in found.operators])
    drawing = ET.fromstring(draw_schedule(schedule))
    groups = [group for group in drawing.iter(f"{SVG}g") if group.find(f"{SVG}svg") is not None]
    bars = [[text.text for text in group.iter(f"{SVG}text")] for group in groups]
    assert bars == [[step.step.action[0], *step.step.action[2:]] for step in schedule.steps]
    assert ["load", "tools", "shelf-b"] in bars
    assert ["load", "lamps", "shelf-b"] in bars

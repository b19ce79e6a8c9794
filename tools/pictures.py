"""Draw the pictures that README shows: `make pictures`."""

import re
from pathlib import Path

from explicable.evaluation.demo import PLAN_TITLES, draw, run_demo
from explicable.first_response import encode, read_map
from explicable.model.durations import read_durations
from explicable.model.files import write_whole
from explicable.model.grounding import ground_team
from explicable.planning import plan_schedule
from explicable.planning.gantt import draw_schedule

MAP = "test-02"
GAP = 24
IMAGES = Path(__file__).parents[1] / "docs" / "images"


def place_side_by_side(pictures: list[str]) -> str:
    """Return one SVG with the pictures in a row."""
    parts, x, height = [], 0.0, 0.0
    for picture in pictures:
        size = re.search(r'viewBox="\S+ \S+ (\S+) (\S+)"', picture)
        if size is None:
            raise ValueError("a picture without a viewBox has no size")
        parts.append(picture.replace("<svg ", f'<svg x="{x}" ', 1))
        x, height = x + float(size[1]) + GAP, max(height, float(size[2]))
    width = x - GAP
    size_of_all = f'viewBox="0 0 {width:g} {height:g}" width="{width:g}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size_of_all}>{"".join(parts)}</svg>\n'


demo = run_demo(seed=0)
records = [record for record in demo.records if record.map == MAP]
pictures = [draw(demo, record, PLAN_TITLES[record.plan_type]) for record in records]
write_whole(IMAGES / "three-plans.svg", place_side_by_side(pictures))

# Few nodes and much time: so the picture is the same each time.
example = Path(__file__).parents[1] / "examples" / "first-response-team"
team_task = ground_team(encode(read_map(example / "team.map"), num_people=2))
planned = plan_schedule(
    team_task, read_durations(example / "durations.toml"), time_limit_s=600.0, max_width=64
)
people = [agent.name for agent in team_task.problem.agents if agent.kind == "human"]
if planned.schedule is None:
    raise RuntimeError("the example has no plan")
title = f"two robots, two people: done at {planned.schedule.makespan:g}"
write_whole(IMAGES / "schedule.svg", draw_schedule(planned.schedule, people=people, title=title))

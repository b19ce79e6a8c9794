"""Draw the pictures that README shows: `make pictures`."""

import re
from pathlib import Path

from explicable.evaluation.demo import PLAN_TITLES, draw, run_demo
from explicable.model.files import write_whole

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

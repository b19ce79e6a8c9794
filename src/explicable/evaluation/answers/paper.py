"""The paper's two tables and its figure, beside the paper's own figures."""

from collections.abc import Sequence
from functools import partial

from explicable.evaluation.answers.rows import Row, group, judged, labelled
from explicable.evaluation.page import Picture, Table, format_estimate
from explicable.evaluation.report import PAPER_RATIOS, PAPER_SCENARIOS
from explicable.evaluation.statistics import estimate
from explicable.first_response import World, render
from explicable.model.plan import parse_plan

TITLES = {"explicable": "explicable", "ff": "FF", "participants": "human (participants')"}
"""The paper's plan types, in the order of its Table 1."""

DIFFERENT = (
    "The paper's figures come from other maps and from people, and its labels are those of its own labeller:"
    " the size of the effect may be compared, but not the figures one by one. Its Tables 1 and 2 do not"
    " agree with each other (method page, section 8)."
)


def paper_tables(rows: Sequence[Row]) -> list[Table]:
    """Make Tables 1 and 2 from the rows with persistent commands, if there are any, cell by cell."""
    chosen = {family: group(found, "plan") for family, found in group(_persistent(rows), "cell").items()}
    return [_table_1(chosen), _table_2(chosen)]


def _persistent(rows: Sequence[Row]) -> list[Row]:
    found = [row for row in rows if row["settings"].get("semantics", "persistent") == "persistent"]
    return found or list(rows)


def _table_1(cells: dict[str, dict[str, list[Row]]]) -> Table:
    lines = [
        (
            f"{cell}: {TITLES[name]}",
            format_estimate(estimate(labelled(plans[name], "f_paper"))),
            format_estimate(estimate(judged(plans[name]))),
            f"{PAPER_RATIOS[name]:.3f}",
        )
        for cell, plans in cells.items()
        for name in TITLES
        if name in plans
    ]
    columns = ("plan", "explicability ratio, labeller", "the same, judged", "paper")
    return Table("table-1", "The paper's Table 1: explicability ratio", columns, tuple(lines), DIFFERENT)


def _table_2(cells: dict[str, dict[str, list[Row]]]) -> Table:
    lines = []
    for cell, plans in cells.items():
        by_map = {name: group(plans[name], "map") for name in ("ff", "explicable") if name in plans}
        for number, place in enumerate(by_map.get("ff", {})):
            paper = PAPER_SCENARIOS[number] if number < len(PAPER_SCENARIOS) else {}
            lines.append(
                (
                    f"{cell}: {place}",
                    *(
                        format_estimate(estimate(labelled(found[place], "f_paper")))
                        for found in by_map.values()
                    ),
                    *(f"{paper[name]:.3f}" if name in paper else "–" for name in by_map),
                )
            )
    columns = ("scenario", "FF", "explicable", "paper: FF", "paper: explicable")
    note = (
        "F of the labeller, over the studies. The paper's scenarios are other maps: rows do not correspond."
    )
    return Table("table-2", "The paper's Table 2: test scenarios", columns, tuple(lines), note)


def paper_pictures(rows: Sequence[Row]) -> list[Picture]:
    """Draw the paper's Figure 3: three plans of one problem, that on which F differs most."""
    first = [row for row in _persistent(rows) if row["repeat"] == 0]
    cell = group(first, "cell").get(first[0]["cell"], []) if first else []
    by_map = {place: {row["plan"]: row for row in found} for place, found in group(cell, "map").items()}
    complete = {place: plans for place, plans in by_map.items() if plans.keys() >= TITLES.keys()}
    if not complete:
        return []
    place = max(
        complete, key=lambda name: complete[name]["explicable"]["f_paper"] - complete[name]["ff"]["f_paper"]
    )
    return [
        Picture(
            f"figure-3-{name}", f"The paper's Figure 3 ({place}, first study): {title}", partial(_draw, row)
        )
        for name, title in (
            ("ff", "FF's plan"),
            ("explicable", "explicable"),
            ("participants", "participant's"),
        )
        for row in [complete[place][name]]
    ]


def _draw(row: Row) -> str:
    actions = parse_plan("\n".join(row["steps"]))
    return render(World(tuple(row["rows"])), "robot", actions, row["labels"])

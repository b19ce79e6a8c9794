"""Which strategy serves a team best while the person acts as it likes."""

from collections.abc import Callable, Sequence

from explicable.evaluation.answers.rows import Row, flatten, format_effect, group
from explicable.evaluation.experiments import Experiment
from explicable.evaluation.page import Picture, Section, Table, format_estimate
from explicable.evaluation.plots import plot_intervals, to_svg
from explicable.evaluation.records import Record
from explicable.evaluation.statistics import Counts, Estimate, compare_with_gee, estimate, estimate_difference

TITLES = {
    "follower": "breadth-first follower",
    "nearest": "autonomous, nearest room",
    "ff": "FF's joint plan",
    "explicable": "explicable",
    "learning": "explicable, learning the person",
    "oracle": "oracle",
}

_Cells = dict[str, dict[str, list[Row]]]


def answer(experiment: Experiment, records: Sequence[Record]) -> Section:
    """Compare strategies within each cell."""
    rows = flatten(experiment, records)
    cells = {cell: group(found, "strategy") for cell, found in group(rows, "cell").items()}
    groups = {
        cell: {TITLES[name]: estimate(_inexplicable(found)) for name, found in plans.items()}
        for cell, plans in cells.items()
    }
    picture = Picture(
        "inexplicable",
        "Inexplicable robot steps in a game, by strategy",
        lambda: to_svg(
            lambda axes: plot_intervals(groups, axes, label="inexplicable robot steps in a game"),
            width=8,
            height=1.2 + 0.9 * len(groups),
        ),
    )
    return Section(
        experiment.name,
        experiment.question,
        tuple(_answer(cell, plans) for cell, plans in cells.items()),
        (_measures(cells), _differences(cells)),
        (picture,),
    )


def _answer(cell: str, plans: dict[str, list[Row]]) -> str:
    means = {name: estimate(_inexplicable(rows)) for name, rows in plans.items() if name != "oracle"}
    best = min(means, key=lambda name: means[name].value)
    text = (
        f"{cell}: fewest inexplicable steps a game with “{TITLES[best]}”, {format_estimate(means[best], 2)}"
    )
    if {"explicable", "follower"} <= plans.keys():
        gain = estimate_difference(_inexplicable(plans["explicable"]), _inexplicable(plans["follower"]))
        time = estimate_difference(_steps(plans["explicable"]), _steps(plans["follower"]))
        text += (
            f"; “explicable” against the follower: {format_estimate(gain, 2)} inexplicable steps,"
            f" {format_estimate(time, 2)} steps of the team"
        )
    return f"{text}."


def _measures(cells: _Cells) -> Table:
    columns: dict[str, Callable[[Row], float | None]] = {
        "inexplicable steps": lambda row: row["num_inexplicable"],
        "team's steps": lambda row: row["num_steps"],
        "deviations": lambda row: row.get("num_deviations"),
        "replans": lambda row: row["num_plans"] - 1 if "num_plans" in row else None,
        "changed requests": lambda row: row.get("num_changes"),
        "planning, ms a game": lambda row: 1000 * row["planning_s"] if "planning_s" in row else None,
    }
    lines = [
        (
            f"{cell}: {TITLES[name]}",
            *(format_estimate(_mean(rows, value), 2) for value in columns.values()),
        )
        for cell, plans in cells.items()
        for name, rows in plans.items()
    ]
    note = (
        "Means a game, with 95 % intervals (bootstrap clustered by problem and participant). The oracle knows"
        " what the participant will hold against it. The"
        " follower plans nothing and predicts nobody, so that its deviations say nothing."
    )
    return Table("measures", "Games in the closed loop", ("strategy", *columns), tuple(lines), note)


def _differences(cells: _Cells) -> Table:
    lines = []
    for cell, plans in cells.items():
        if "follower" not in plans:
            continue
        several = len({row["map"] for row in plans["follower"]}) > 1
        answers = {name: _explicable(rows) for name, rows in plans.items()}
        effects = {e.name: e for e in compare_with_gee(answers, "follower")} if several else {}
        for name, rows in plans.items():
            if name == "follower":
                continue
            gain = estimate_difference(_inexplicable(rows), _inexplicable(plans["follower"]))
            lines.append(
                (
                    f"{cell}: {TITLES[name]} − follower",
                    format_estimate(gain, 2),
                    *format_effect(effects.get(name)),
                )
            )
    columns = ("difference", "inexplicable steps a game", "odds ratio of a step to be explicable", "p (Holm)")
    note = "Odds ratios from a logistic GEE with exchangeable answers within problems; p: Holm's correction."
    return Table("differences", "Against the breadth-first follower", columns, tuple(lines), note)


def _mean(rows: Sequence[Row], value: Callable[[Row], float | None]) -> Estimate | None:
    present = [row for row in rows if value(row) is not None]
    return estimate(_counts(present, lambda row: value(row) or 0.0)) if present else None


def _counts(
    rows: Sequence[Row], part: Callable[[Row], float], whole: Callable[[Row], float] = lambda _: 1.0
) -> Counts:
    return Counts(
        [part(row) for row in rows],
        [whole(row) for row in rows],
        [row["map"] for row in rows],
        [(row["repeat"], row["player"]) for row in rows],
    )


def _inexplicable(rows: Sequence[Row]) -> Counts:
    return _counts(rows, lambda row: row["num_inexplicable"])


def _steps(rows: Sequence[Row]) -> Counts:
    return _counts(rows, lambda row: row["num_steps"])


def _explicable(rows: Sequence[Row]) -> Counts:
    return _counts(
        rows, lambda row: row["num_robot_steps"] - row["num_inexplicable"], lambda row: row["num_robot_steps"]
    )

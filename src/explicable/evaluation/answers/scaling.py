"""How time and memory grow."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from explicable.evaluation.answers.rows import Row, flatten, group, means
from explicable.evaluation.experiments import Experiment
from explicable.evaluation.page import Picture, Section, Table, format_estimate
from explicable.evaluation.plots import plot_intervals, to_svg
from explicable.evaluation.records import Record
from explicable.evaluation.statistics import Estimate
from explicable.evaluation.trials.scaling import MAX_EVALUATIONS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLES = {
    "num_operators": ("operators", 1.0, 0),
    "ground_s": ("grounding, ms", 1000.0, 1),
    "tables_s": ("feature tables, ms", 1000.0, 1),
    "ff_plan_s": ("FF, ms", 1000.0, 1),
    "ff_gave_up": ("FF without a plan", 1.0, 2),
    "default_plan_s": ("default search, ms", 1000.0, 1),
    "explicable_plan_s": ("first explicable plan, ms", 1000.0, 1),
    "memory_bytes": ("memory, MB", 1e-6, 1),
}


def answer(experiment: Experiment, records: Sequence[Record]) -> Section:
    """Give times and memory by cell."""
    rows = [row | {"ff_gave_up": float(row["ff_cost"] is None)} for row in flatten(experiment, records)]
    cells = group(rows, "cell")
    found = {cell: {name: _mean(rows, name) for name in TITLES} for cell, rows in cells.items()}
    lines = [
        (cell, *(format_estimate(row[name], TITLES[name][2]) for name in TITLES))
        for cell, row in found.items()
    ]
    drawn = {
        cell: {
            TITLES[name][0]: estimate
            for name in ("ground_s", "ff_plan_s", "explicable_plan_s")
            if (estimate := row[name]) is not None
        }
        for cell, row in found.items()
    }

    def draw(axes: "Axes") -> None:
        plot_intervals(drawn, axes, label="milliseconds")
        axes.set_xscale("log")

    note = (
        "Means over maps with 95 % intervals. Times are wall-clock of one process, on a machine that may have"
        f" had other work. Each search ends after {MAX_EVALUATIONS} evaluations; the share of maps on which"
        " FF had no plan by then is given; its time there is that until it gave up. Memory is the most that"
        " the process held beyond what it held before, while it grounded a map and planned for it."
    )
    columns = ("size", *(title for title, _, _ in TITLES.values()))
    return Section(
        experiment.name,
        experiment.question,
        tuple(
            f"{cell}: first explicable plan after {format_estimate(row['explicable_plan_s'], 1)} ms."
            for cell, row in found.items()
        ),
        (Table("costs", "Time and memory", columns, tuple(lines), note),),
        (Picture("times", "Time by size", lambda: to_svg(draw, width=8, height=1.5 + 0.5 * len(drawn))),),
    )


def _mean(rows: Sequence[Row], name: str) -> Estimate | None:
    factor = TITLES[name][1]
    return means(rows, lambda row: row[name] * factor)

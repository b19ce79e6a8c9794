"""Pictures of how explicable plans are, and at what length."""

from typing import TYPE_CHECKING

from explicable.evaluation.answers.plan_cells import TITLES, Cells, extra_cost, percent
from explicable.evaluation.answers.rows import Row, judged, labelled
from explicable.evaluation.page import Picture
from explicable.evaluation.plots import plot_curves, plot_intervals, to_svg
from explicable.evaluation.statistics import Estimate, estimate, power_curve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

POWER_SIZES = (4, 8, 16, 32, 64, 128)
MIN_PROBLEMS = 20
"""Fewer say too little about how problems differ for a power curve."""


def plan_pictures(cells: Cells) -> list[Picture]:
    """Draw what the cells have plans and problems enough for."""
    pictures = [
        Picture(
            "judged", "Share of robot steps that participants call explicable", lambda: _draw_judged(cells)
        )
    ]
    measured = [
        cell
        for cell, plans in cells.items()
        if {"ff", "explicable"} <= plans.keys() and len({row["map"] for row in plans["ff"]}) >= MIN_PROBLEMS
    ]
    if measured:
        title = "How many problems a study needs to find explicable − FF (judged F)"
        pictures.append(Picture("power", title, lambda: _draw_power({c: cells[c] for c in measured})))
    priced = {alpha: plans for plans in cells.values() for alpha in [_alpha(plans)] if alpha is not None}
    if len(priced) > 1:
        pictures.append(
            Picture("front", "Explicability against length, by alpha", lambda: _draw_front(priced))
        )
    return pictures


def _draw_judged(cells: Cells) -> str:
    groups = {
        cell: {TITLES[name]: estimate(judged(rows, all_steps=False)) for name, rows in plans.items()}
        for cell, plans in cells.items()
    }
    height = 1.2 + 0.16 * sum(map(len, groups.values()))
    return to_svg(lambda axes: plot_intervals(groups, axes, label="F_robot, judged"), width=9, height=height)


def _draw_power(cells: Cells) -> str:
    curves = {}
    for cell, plans in cells.items():
        curve = power_curve(judged(plans["explicable"]), judged(plans["ff"]), POWER_SIZES)
        curves[cell] = [(float(size), Estimate(share, share, share, 200, size)) for size, share in curve]
    return to_svg(
        lambda axes: plot_curves(
            curves, axes, x_label="problems in a study", y_label="share of studies that find it", log_x=True
        ),
        width=8,
    )


def _alpha(plans: dict[str, list[Row]]) -> float | None:
    """Return the price of an inexplicable step that a cell names."""
    row = next((row for name, rows in plans.items() if name != "shortest" for row in rows), None)
    return row["settings"].get("alpha") if row and {"explicable", "shortest"} <= plans.keys() else None


def _draw_front(priced: dict[float, dict[str, list[Row]]]) -> str:
    """Draw what more length buys: each point is the explicable plans of one alpha."""
    found = {
        alpha: (percent(extra_cost(plans["explicable"], plans["shortest"])).value, plans["explicable"])
        for alpha, plans in sorted(priced.items())
    }
    curves = {
        title: [(extra, estimate(counts(rows))) for extra, rows in found.values()]
        for title, counts in (
            ("to the labeller", lambda rows: labelled(rows, "f_paper")),
            ("to participants who judge", judged),
        )
    }

    def draw(axes: "Axes") -> None:
        plot_curves(curves, axes, x_label="% longer than the shortest plan", y_label="F")
        places: dict[tuple[float, float], list[str]] = {}
        for alpha, (extra, rows) in found.items():
            share = estimate(labelled(rows, "f_paper")).value
            places.setdefault((round(extra, 1), round(share, 2)), []).append(f"{alpha:g}")
        for place, names in places.items():
            axes.annotate(", ".join(names), place, (6, 6), textcoords="offset points")

    return to_svg(draw, width=8)

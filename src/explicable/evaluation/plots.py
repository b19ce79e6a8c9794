"""Figures: the only place that touches the plotting library.

Functions named ``plot_*`` take data and axes, and neither compute nor save; `to_svg` makes a picture of what
they draw. Series differ in marker and line as well as in colour (Okabe & Ito's palette), so that figures can
be read in grey and by colour-blind readers.
"""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from explicable.evaluation.statistics import Estimate
from explicable.model.drawing import Drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from explicable.planning import FrontPlan

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000", "#7f7f7f", "#8c510a")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*", "<")
LINES = ("-", "--", "-.", ":", "-", "--", "-.", ":", "-")

_STYLE: dict[Any, Any] = {
    "font.size": 10,
    "font.family": "sans-serif",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#d9d9d9",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "svg.fonttype": "none",
    "svg.hashsalt": "explicable",
    "legend.frameon": False,
    "figure.facecolor": "white",
}


def to_svg(draw: "Callable[[Axes], None]", *, width: float = 6.4, height: float = 3.6) -> Drawing:
    """Draw on fresh axes and return the picture as an SVG element, which a notebook shows.

    The same drawing gives the same text.

    Parameters
    ----------
    draw
        Is given the axes.
    width, height
        In inches.

    Examples
    --------
    >>> to_svg(lambda axes: axes.set_title("Nothing"))[:4]
    '<svg'
    """
    text = _draw(draw, "svg", width, height).decode()
    return Drawing(text[text.index("<svg") :])


def to_png(draw: "Callable[[Axes], None]", *, width: float = 6.4, height: float = 3.6) -> bytes:
    r"""Draw on fresh axes and return the picture as a PNG file's content, at 200 dots an inch.

    Examples
    --------
    >>> to_png(lambda axes: axes.set_title("Nothing"))[:4]
    b'\x89PNG'
    """
    return _draw(draw, "png", width, height)


def _draw(draw: "Callable[[Axes], None]", kind: str, width: float, height: float) -> bytes:
    import io

    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        draw(figure.subplots())
        stream = io.BytesIO()
        figure.savefig(stream, format=kind, dpi=200, metadata={"Date": None} if kind == "svg" else None)
    return stream.getvalue()


def plot_front(plans: "Sequence[FrontPlan]", axes: "Axes", *, chosen: "FrontPlan | None" = None) -> None:
    """Plot a front: what the plans cost, and how many of their steps are expected to be inexplicable.

    Each plan has its number and E[F]; between two corners stands the alpha at which both are as good. Plans
    that are best at no alpha are small. One that is not proved best is hollow, that of a budget has a ring.

    Parameters
    ----------
    plans
        As `explicable.planning.front` gives them.
    chosen
        The plan that was chosen, if one was.
    """
    corners = [found for found in plans if found.alpha_from is not None]
    costs = [found.plan.cost for found in corners]
    counts = [found.num_inexplicable for found in corners]
    axes.plot(costs, counts, color="#777777", linewidth=1.2, zorder=1)
    for number, found in enumerate(plans, start=1):
        place = (found.plan.cost, found.num_inexplicable)
        face = COLOURS[0] if found.is_proved else "white"
        size = 8 if found in corners else 5
        axes.plot(*place, marker="o", markersize=size, color=COLOURS[0], markerfacecolor=face, zorder=2)
        if found is chosen:
            axes.plot(*place, marker="o", markersize=15, color="black", markerfacecolor="none", zorder=2)
        text = f"plan {number}: E[F] = {found.explicability:.2f}"
        axes.annotate(text, place, xytext=(9, 7), textcoords="offset points")
    for left, right in pairwise(corners):
        middle = (
            (left.plan.cost + right.plan.cost) / 2,
            (left.num_inexplicable + right.num_inexplicable) / 2,
        )
        axes.annotate(
            f"\N{GREEK SMALL LETTER ALPHA} = {left.alpha_to:.2g}",
            middle,
            xytext=(-7, -5),
            textcoords="offset points",
            ha="right",
            va="top",
            color="#444444",
            fontstyle="italic",
        )
    axes.margins(x=0.25, y=0.2)
    axes.set_ylim(bottom=min(0.0, *axes.get_ylim()))
    axes.locator_params(axis="x", integer=True)
    axes.set_xlabel("cost of the plan")
    axes.set_ylabel("expected number of inexplicable steps")


def plot_intervals(
    groups: Mapping[str, Mapping[str, Estimate]], axes: "Axes", *, label: str, reference: float | None = None
) -> None:
    """Plot estimates with their intervals: one line of marks a group, one mark a name.

    Parameters
    ----------
    groups
        Estimates by group (rows) and name (marks).
    label
        Of the axis.
    reference
        Where to draw a line, if anywhere.
    """
    names = list(dict.fromkeys(name for row in groups.values() for name in row))
    for number, name in enumerate(names):
        shift = 0.0 if len(names) == 1 else 0.6 * (number / (len(names) - 1) - 0.5)
        found = [(place, row[name]) for place, row in enumerate(groups.values()) if name in row]
        axes.errorbar(
            [one.value for _, one in found],
            [place + shift for place, _ in found],
            xerr=[
                [max(one.value - one.low, 0.0) for _, one in found],
                [max(one.high - one.value, 0.0) for _, one in found],
            ],
            fmt=MARKERS[number % len(MARKERS)],
            color=COLOURS[number % len(COLOURS)],
            markersize=5,
            capsize=2,
            linewidth=1.2,
            label=name,
        )
    if reference is not None:
        axes.axvline(reference, color="#555555", linewidth=1)
    axes.set_yticks(range(len(groups)), list(groups))
    axes.set_ylim(len(groups) - 0.4, -0.6)
    axes.set_xlabel(label)
    if len(names) > 1:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


def plot_curves(
    curves: Mapping[str, Sequence[tuple[float, Estimate]]],
    axes: "Axes",
    *,
    x_label: str,
    y_label: str,
    log_x: bool = False,
    log_y: bool = False,
) -> None:
    """Plot estimates against a number, a line a curve, their intervals as bars."""
    for number, (name, points) in enumerate(curves.items()):
        axes.errorbar(
            [x for x, _ in points],
            [one.value for _, one in points],
            yerr=[
                [max(one.value - one.low, 0.0) for _, one in points],
                [max(one.high - one.value, 0.0) for _, one in points],
            ],
            fmt=MARKERS[number % len(MARKERS)],
            linestyle=LINES[number % len(LINES)],
            color=COLOURS[number % len(COLOURS)],
            markersize=5,
            capsize=2,
            linewidth=1.4,
            label=name,
        )
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    if log_x:
        axes.set_xscale("log")
    if log_y:
        axes.set_yscale("log")
    if len(curves) > 1:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


def plot_calibration(curves: Mapping[str, Sequence[tuple[float, float, int]]], axes: "Axes") -> None:
    """Plot observed shares against predicted probabilities; marks grow with the number of steps.

    Parameters
    ----------
    curves
        By name: predicted, observed, number of steps of each bin.
    """
    axes.plot([0, 1], [0, 1], color="#777777", linewidth=1)
    for number, (name, bins) in enumerate(curves.items()):
        axes.scatter(
            [predicted for predicted, _, _ in bins],
            [observed for _, observed, _ in bins],
            s=[8 + min(num / 20, 120) for _, _, num in bins],
            marker=MARKERS[number % len(MARKERS)],
            color=COLOURS[number % len(COLOURS)],
            alpha=0.8,
            label=name,
        )
    axes.set_xlabel("predicted probability that a step is explicable")
    axes.set_ylabel("share called explicable")
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

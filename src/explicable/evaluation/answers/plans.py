"""Which plans are explicable, to the labeller and to participants, and what that costs."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.evaluation.answers.paper import paper_pictures, paper_tables
from explicable.evaluation.answers.rows import (
    Row,
    flatten,
    format_effect,
    group,
    judged,
    labelled,
    means,
)
from explicable.evaluation.experiments import Experiment
from explicable.evaluation.page import Picture, Section, Table, format_estimate
from explicable.evaluation.plots import plot_curves, plot_intervals, to_svg
from explicable.evaluation.records import Record
from explicable.evaluation.statistics import (
    Counts,
    Estimate,
    compare_with_gee,
    estimate,
    estimate_difference,
    estimate_ratio,
    power_curve,
    standardised_difference,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLES = {
    "ff": "FF",
    "shortest": "shortest (A*)",
    "paper": "explicable, as in the paper",
    "greedy": "explicable, first plan",
    "greedy-viterbi": "explicable, first plan, Viterbi F",
    "greedy-context": "explicable, first plan, context-aware closing",
    "explicable": "explicable",
    "budget": "explicable, 5 % dearer at most",
    "charged": "explicable, human steps charged",
    "ceiling": "ceiling: best to the judges, their minds known",
    "participants": "participants' own",
}
HEADLINES = ("explicable", "paper")
"""The plans of which a section's headline speaks."""
MIN_GAIN, MAX_EXTRA = 0.10, 0.05
"""What the paper's effect comes to: so much more F than FF's plan, at so much more cost than the shortest."""

_Cells = dict[str, dict[str, list[Row]]]  # rows by cell and plan

POWER_SIZES = (4, 8, 16, 32, 64, 128)
MIN_PROBLEMS = 20
"""Fewer say too little about how problems differ for a power curve."""


def answer(experiment: Experiment, records: Sequence[Record]) -> Section:
    """Compare plans within each cell."""
    rows = [row for row in flatten(experiment, records) if "num_steps" in row]
    cells = {cell: group(found, "plan") for cell, found in group(rows, "cell").items()}
    is_paper = any("steps" in row for row in rows)
    effects = _effects(cells)
    answers = list(_answers(effects) if effects else _gains_in_words(cells))
    tables = [*(paper_tables(rows) if is_paper else ()), *([_effect_table(effects)] if effects else ())]
    return Section(
        experiment.name,
        experiment.question,
        tuple(text for _, text in answers),
        (*tables, _scores(cells), _differences(cells)),
        (*_pictures(cells), *(paper_pictures(rows) if is_paper else ())),
        _headline(answers),
    )


def _headline(answers: Sequence[tuple[str, str]]) -> str:
    """Say what the planner does by default, and beside it what it does as in the paper.

    Examples
    --------
    >>> _headline([("paper", "Little."), ("explicable", "Much."), ("explicable", "Much, elsewhere.")])
    'Much. Little.'
    """
    return " ".join(dict(reversed(answers))[name] for name in HEADLINES if name in dict(answers))


@dataclass(frozen=True, slots=True)
class _Effect:
    """What the paper's effect comes to for one plan in one cell."""

    cell: str
    name: str
    over_ff: tuple[Estimate, Estimate]  # in F, by the labeller and by judges
    over_own: tuple[Estimate, Estimate]
    extra: Estimate


def _effects(cells: _Cells) -> list[_Effect]:
    """Hold each explicable planner against FF, the participants and the shortest plan."""
    return [
        _Effect(cell, name, over_ff, over_own, _extra_cost(plans[name], plans["shortest"]))
        for cell, plans in cells.items()
        if plans.keys() >= {"ff", "participants", "shortest"}
        for name in plans
        if name not in {"ff", "participants", "shortest"}
        for over_ff, over_own in [
            (_gains(plans[name], plans["ff"]), _gains(plans[name], plans["participants"]))
        ]
    ]


def _gains(rows: Sequence[Row], others: Sequence[Row]) -> tuple[Estimate, Estimate]:
    by_labeller = estimate_difference(labelled(rows, "f_paper"), labelled(others, "f_paper"))
    return by_labeller, estimate_difference(judged(rows), judged(others))


def _answers(effects: Sequence[_Effect]) -> Iterator[tuple[str, str]]:
    """Say of each planner, by name, in how many cells each part of the paper's effect is reached."""
    for name in dict.fromkeys(effect.name for effect in effects):
        mine = [effect for effect in effects if effect.name == name]
        above_ff = [sum(effect.over_ff[who].value >= MIN_GAIN for effect in mine) for who in (0, 1)]
        above_own = [sum(effect.over_own[who].value >= 0.0 for effect in mine) for who in (0, 1)]
        num_short = sum(effect.extra.value <= MAX_EXTRA for effect in mine)
        cells = f"of {len(mine)} cell{'s' if len(mine) > 1 else ''}"
        yield (
            name,
            f"Plan “{TITLES[name]}”: F is at least 0.10 above that of FF's plan in {above_ff[0]} {cells} to"
            f" the labeller, in {above_ff[1]} to participants who judge; at least that of participants' own"
            f" plans in {above_own[0]} and {above_own[1]}; at most 5 % longer than the shortest in"
            f" {num_short}.",
        )


def _gains_in_words(cells: _Cells) -> Iterator[tuple[str, str]]:
    """Say, by name, what each explicable planner gains over FF's plan, and at what length."""
    for cell, plans in cells.items():
        for name, rows in plans.items():
            if name in {"ff", "shortest", "participants"} or "ff" not in plans:
                continue
            text = (
                f"{cell}: plan “{TITLES[name]}” has F {format_estimate(estimate(judged(rows)))} to"
                f" participants who judge: {format_estimate(_gains(rows, plans['ff'])[1])} over FF's plan"
            )
            if "shortest" in plans:
                extra = _percent(_extra_cost(rows, plans["shortest"]))
                text += f", and is {format_estimate(extra, 1, ' %')} longer than the shortest"
            yield name, f"{text}."


def _effect_table(effects: Sequence[_Effect]) -> Table:
    lines = [
        (
            f"{effect.cell}: {TITLES[effect.name]}",
            *(format_estimate(found) for found in (*effect.over_ff, *effect.over_own)),
            format_estimate(_percent(effect.extra), 1, " %"),
        )
        for effect in effects
    ]
    columns = (
        "plan",
        "F − FF's, labeller",
        "F − FF's, judged",
        "F − participants', labeller",
        "F − participants', judged",
        "longer than shortest",
    )
    note = (
        "Targets: at least 0.10 above FF, at least the participants' F, at most 5 % longer than the shortest."
    )
    return Table("effect", "The paper's effect", columns, tuple(lines), note)


def _scores(cells: _Cells) -> Table:
    lines = []
    for cell, plans in cells.items():
        for name, rows in plans.items():
            extra = _extra_cost(rows, plans["shortest"]) if "shortest" in plans else None
            lines.append(
                (
                    f"{cell}: {TITLES[name]}",
                    format_estimate(estimate(labelled(rows, "f_paper"))),
                    format_estimate(estimate(labelled(rows, "f_expected"))),
                    format_estimate(estimate(judged(rows))),
                    format_estimate(estimate(judged(rows, all_steps=False))),
                    format_estimate(means(rows, lambda row: row.get("f_human"))),
                    format_estimate(_percent(extra), 1, " %") if extra else "–",
                )
            )
    columns = (
        "plan",
        "F, labeller",
        "E[F]",
        "F, judged",
        "F_robot, judged",
        "F_human",
        "longer than shortest",
    )
    note = (
        "Pooled, with 95 % intervals (bootstrap clustered by problem and participants). F, labeller:"
        " of the most probable labels; human steps count as explicable, as in the paper. Judged: by simulated"
        " participants who had no part in training. n: plans, or plans times judges."
    )
    return Table("scores", "Explicability and length", columns, tuple(lines), note)


def _differences(cells: _Cells) -> Table:
    """Compare every plan with FF's: differences, effect sizes, a GEE with Holm's correction in a cell."""
    lines = []
    for cell, plans in cells.items():
        reference = "ff" if "ff" in plans else next(iter(plans))
        robots = {name: judged(rows, all_steps=False) for name, rows in plans.items()}
        several = len({row["map"] for rows in plans.values() for row in rows}) > 1
        effects = {e.name: e for e in compare_with_gee(robots, reference)} if several else {}
        for name, rows in plans.items():
            if name == reference:
                continue
            pairs = _paired(rows, plans[reference])
            lines.append(
                (
                    f"{cell}: {TITLES[name]} − {TITLES[reference]}",
                    format_estimate(
                        estimate_difference(labelled(rows, "f_paper"), labelled(plans[reference], "f_paper"))
                    ),
                    format_estimate(estimate_difference(judged(rows), judged(plans[reference]))),
                    f"{standardised_difference(*pairs):.2f} (n = {len(pairs[0])})",
                    *format_effect(effects.get(name)),
                )
            )
    note = (
        "Cohen's d: of the judged F of the two plans for the same map. Odds ratio: of a judged robot step"
        " to be explicable, from a logistic GEE with exchangeable answers within problems; p: after Holm's"
        " correction for the comparisons of a row's cell."
    )
    columns = ("difference", "F, labeller", "F, judged", "Cohen's d", "odds ratio", "p (Holm)")
    return Table("differences", "Differences", columns, tuple(lines), note)


def _paired(rows: Sequence[Row], others: Sequence[Row]) -> tuple[list[float], list[float]]:
    theirs = {(row["repeat"], row["map"]): _judged_share(row) for row in others}
    shared = [row for row in rows if (row["repeat"], row["map"]) in theirs]
    return [_judged_share(row) for row in shared], [theirs[row["repeat"], row["map"]] for row in shared]


def _judged_share(row: Row) -> float:
    counts = judged([row])
    return sum(counts.part) / sum(counts.whole)


def _extra_cost(rows: Sequence[Row], shortest: Sequence[Row]) -> Estimate:
    ratio = estimate_ratio(_costs(rows), _costs(shortest))
    return Estimate(ratio.value - 1, ratio.low - 1, ratio.high - 1, ratio.num, ratio.num_clusters)


def _costs(rows: Sequence[Row]) -> Counts:
    return Counts(
        [row["cost"] for row in rows],
        [1.0] * len(rows),
        [row["map"] for row in rows],
        [row["repeat"] for row in rows],
    )


def _percent(found: Estimate) -> Estimate:
    return Estimate(100 * found.value, 100 * found.low, 100 * found.high, found.num, found.num_clusters)


def _pictures(cells: _Cells) -> list[Picture]:
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


def _draw_judged(cells: _Cells) -> str:
    groups = {
        cell: {TITLES[name]: estimate(judged(rows, all_steps=False)) for name, rows in plans.items()}
        for cell, plans in cells.items()
    }
    height = 1.2 + 0.16 * sum(map(len, groups.values()))
    return to_svg(lambda axes: plot_intervals(groups, axes, label="F_robot, judged"), width=9, height=height)


def _draw_power(cells: _Cells) -> str:
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
        alpha: (_percent(_extra_cost(plans["explicable"], plans["shortest"])).value, plans["explicable"])
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

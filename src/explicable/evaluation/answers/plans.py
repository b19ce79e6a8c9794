"""Which plans are explicable, to the labeller and to participants, and what that costs."""

from collections.abc import Sequence

from explicable.evaluation.answers.paper import paper_pictures, paper_tables
from explicable.evaluation.answers.paper_effect import effect_table, find_effects, say_effects, say_gains
from explicable.evaluation.answers.plan_cells import TITLES, Cells, extra_cost, percent
from explicable.evaluation.answers.plan_pictures import plan_pictures
from explicable.evaluation.answers.rows import Row, flatten, format_effect, group, judged, labelled, means
from explicable.evaluation.experiments import Experiment
from explicable.evaluation.page import Section, Table, format_estimate
from explicable.evaluation.records import Record
from explicable.evaluation.statistics import (
    compare_with_gee,
    estimate,
    estimate_difference,
    standardised_difference,
)

HEADLINES = ("explicable", "paper")
"""The plans of which a section's headline speaks."""


def answer(experiment: Experiment, records: Sequence[Record]) -> Section:
    """Compare plans within each cell."""
    rows = [row for row in flatten(experiment, records) if "num_steps" in row]
    cells = {cell: group(found, "plan") for cell, found in group(rows, "cell").items()}
    is_paper = any("steps" in row for row in rows)
    effects = find_effects(cells)
    answers = list(say_effects(effects) if effects else say_gains(cells))
    tables = [*(paper_tables(rows) if is_paper else ()), *([effect_table(effects)] if effects else ())]
    return Section(
        experiment.name,
        experiment.question,
        tuple(text for _, text in answers),
        (*tables, _scores(cells), _differences(cells)),
        (*plan_pictures(cells), *(paper_pictures(rows) if is_paper else ())),
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


def _scores(cells: Cells) -> Table:
    lines = []
    for cell, plans in cells.items():
        for name, rows in plans.items():
            extra = extra_cost(rows, plans["shortest"]) if "shortest" in plans else None
            lines.append(
                (
                    f"{cell}: {TITLES[name]}",
                    format_estimate(estimate(labelled(rows, "f_paper"))),
                    format_estimate(estimate(labelled(rows, "f_expected"))),
                    format_estimate(estimate(judged(rows))),
                    format_estimate(estimate(judged(rows, all_steps=False))),
                    format_estimate(means(rows, lambda row: row.get("f_human"))),
                    format_estimate(percent(extra), 1, " %") if extra else "–",
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


def _differences(cells: Cells) -> Table:
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

"""How far predicted labels can be trusted."""

import math
from collections.abc import Callable, Sequence

from explicable.evaluation.answers.rows import Row, flatten, group, means
from explicable.evaluation.experiments import Experiment
from explicable.evaluation.page import Picture, Section, Table, format_estimate
from explicable.evaluation.plots import plot_calibration, to_svg
from explicable.evaluation.records import Record
from explicable.evaluation.statistics import Counts, Estimate, estimate
from explicable.labelling.quality import label_quality

PLANS = {
    "participants": "participants' own games",
    "ff": "FF's plans",
    "explicable": "explicable plans",
}

_Cells = dict[str, dict[str, list[Row]]]


def answer(experiment: Experiment, records: Sequence[Record]) -> Section:
    """Compare predictions with what participants said, by cell and kind of plan."""
    rows = flatten(experiment, records)
    cells = {cell: group(found, "plan") for cell, found in group(rows, "cell").items()}
    return Section(
        experiment.name,
        experiment.question,
        tuple(_answer(cell, plans) for cell, plans in cells.items()),
        (_quality(cells),),
        (_calibration(cells),),
    )


def _answer(cell: str, plans: dict[str, list[Row]]) -> str:
    parts = [
        f"{PLANS[name]} {format_estimate(_log_loss(rows))} nats, E[F] − F {format_estimate(_bias(rows))}"
        for name, rows in plans.items()
    ]
    return f"{cell}: held-out log-loss on {'; on '.join(parts)}."


def _quality(cells: _Cells) -> Table:
    columns: dict[str, Callable[[Sequence[Row]], Estimate | None]] = {
        "log-loss": _log_loss,
        "log-loss of the base rate": _base_log_loss,
        "E[F] − F": _bias,
        "|E[F] − F|": lambda rows: means(rows, lambda row: abs(_expected(row) - _observed(row))),
        "Viterbi F − F": lambda rows: means(rows, lambda row: row["viterbi"] - _observed(row)),
        "interval covers": lambda rows: means(rows, _covers),
        "agreement": lambda rows: means(rows, lambda row: row["agreement"]),
    }
    lines = []
    for cell, plans in cells.items():
        for name, rows in plans.items():
            labels, probabilities = _steps(rows)
            quality = label_quality(labels, probabilities)
            lines.append(
                (
                    f"{cell}: {PLANS[name]}",
                    *(format_estimate(value(rows)) for value in columns.values()),
                    f"{quality.auc:.3f} (n = {quality.num_steps})" if quality.auc is not None else "–",
                    f"{quality.calibration.error:.3f} (n = {quality.num_steps})",
                )
            )
    note = (
        "Of robot steps of plans on maps, and by participants, that training has not seen; F is F_robot."
        " Agreement: Krippendorff's alpha of the participants who judged the same plan. Interval: whether the"
        " 95 % interval covers F, where a bootstrap was made. n: plans; steps (AUC, calibration error)."
    )
    headings = ("plans", *columns, "AUC", "calibration error")
    return Table("quality", "Predicted labels against participants' answers", headings, tuple(lines), note)


def _calibration(cells: _Cells) -> Picture:
    curves = {}
    for cell, plans in list(cells.items())[:2]:
        for name, rows in plans.items():
            found = label_quality(*_steps(rows)).calibration
            curves[f"{cell}: {PLANS[name]}"] = list(
                zip(found.predicted.tolist(), found.observed.tolist(), found.num_steps.tolist(), strict=True)
            )
    return Picture(
        "calibration",
        "Calibration (first two cells)",
        lambda: to_svg(lambda axes: plot_calibration(curves, axes), width=8, height=4),
    )


def _steps(rows: Sequence[Row]) -> tuple[list[bool], list[float]]:
    pairs = [pair for row in rows for pair in zip(row["labels"], row["probabilities"], strict=True)]
    return [label for label, _ in pairs], [p for _, p in pairs]


def _log_loss(rows: Sequence[Row]) -> Estimate:
    return _mean_loss(rows, lambda row: row["probabilities"])


def _base_log_loss(rows: Sequence[Row]) -> Estimate:
    labels = [label for row in rows for label in row["labels"]]
    rate = sum(labels) / len(labels)
    return _mean_loss(rows, lambda row: [rate] * len(row["labels"]))


def _mean_loss(rows: Sequence[Row], probabilities: Callable[[Row], Sequence[float]]) -> Estimate:
    """Estimate the mean of -log(probability of the label given) over steps."""
    sums = [
        sum(
            -math.log(max(p if label else 1 - p, 1e-4))
            for label, p in zip(row["labels"], probabilities(row), strict=True)
        )
        for row in rows
    ]
    lengths = [len(row["labels"]) for row in rows]
    return estimate(Counts(sums, lengths, [row["map"] for row in rows], [row["repeat"] for row in rows]))


def _expected(row: Row) -> float:
    return sum(row["probabilities"]) / len(row["probabilities"])


def _observed(row: Row) -> float:
    return sum(row["labels"]) / len(row["labels"])


def _bias(rows: Sequence[Row]) -> Estimate | None:
    return means(rows, lambda row: _expected(row) - _observed(row))


def _covers(row: Row) -> float | None:
    if "interval" not in row:
        return None
    low, high = row["interval"]
    return float(low - 1e-9 <= _observed(row) <= high + 1e-9)

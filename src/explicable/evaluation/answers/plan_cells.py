"""Plans by cell of an experiment: what they are called, and how much longer than the shortest they are."""

from collections.abc import Sequence

from explicable.evaluation.answers.rows import Row
from explicable.evaluation.statistics import Counts, Estimate, estimate_ratio

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

Cells = dict[str, dict[str, list[Row]]]  # rows by cell and plan


def extra_cost(rows: Sequence[Row], shortest: Sequence[Row]) -> Estimate:
    """Estimate by what share plans are dearer than the shortest."""
    ratio = estimate_ratio(_costs(rows), _costs(shortest))
    return Estimate(ratio.value - 1, ratio.low - 1, ratio.high - 1, ratio.num, ratio.num_clusters)


def _costs(rows: Sequence[Row]) -> Counts:
    return Counts(
        [row["cost"] for row in rows],
        [1.0] * len(rows),
        [row["map"] for row in rows],
        [row["repeat"] for row in rows],
    )


def percent(found: Estimate) -> Estimate:
    """Turn a share into per cent."""
    return Estimate(100 * found.value, 100 * found.low, 100 * found.high, found.num, found.num_clusters)

"""The labeller's part of `docs/benchmarks.md`, made from `records/labeller.jsonl` and from nothing else.

`label_quality.py`, `questions.py`, `node_scoring.py` and `objective.py` append to that file with ``-o``.
Usage, to renew this part of the page alone: ``python labeller_page.py``.
"""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from tables import markdown_table

HERE = Path(__file__).parent
RECORDS = HERE / "records" / "labeller.jsonl"
PAGE = HERE.parent / "docs" / "benchmarks.md"
HEADING = "## The labeller\n"
FIGURES = {
    "mae_robot": "error of E[F], robots' steps",
    "mae_all_steps": "error of E[F], all steps",
    "covered_95": "in the 95 % interval",
    "covered_90": "in the 90 % interval",
    "log_loss": "log-loss",
    "calibration_error": "calibration error",
}


def sections(records: Path = RECORDS) -> Iterator[str]:
    """Yield the parts of the labeller's section; none without records."""
    if not records.is_file():
        return
    runs = [json.loads(line) for line in records.read_text().splitlines()]
    yield HEADING
    yield "Simulated participants are test instruments: these figures say nothing about people.\n"
    yield from _predictions([run for run in runs if run["experiment"] == "labels"])
    yield from _questions([run for run in runs if run["experiment"] == "questions"])
    yield from _nodes([run for run in runs if run["experiment"] == "nodes"])
    yield from _objectives([run for run in runs if run["experiment"] == "objectives"])
    yield from _first_plans([run for run in runs if run["experiment"] == "first plans"])


def _spread(values: list[float]) -> str:
    """Return the mean with its 95 % interval, by a bootstrap over training sets."""
    rng = np.random.default_rng(0)
    means = rng.choice(values, (5000, len(values))).mean(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return f"{np.mean(values):.3f} [{low:.3f}, {high:.3f}]"


def _predictions(runs: list[dict]) -> Iterator[str]:
    if not runs:
        return
    seeds = sorted({run["seed"] for run in runs})
    yield "### Held-out predictions\n"
    plans = runs[0]["plans"]
    yield f"Labellers of 34 traces (16 maps, 9 participants), {len(seeds)} training sets of each family,"
    yield f"seeds from {seeds[0]}; for each, {plans} plans that new participants of each family played and"
    yield "labelled on new maps. Mean absolute errors, and shares of plans whose F_robot lay in the interval:"
    yield "means over training sets, in brackets their 95 % interval (bootstrap over training sets).\n"
    rows = []
    for pair in dict.fromkeys((run["trained_on"], run["tested_on"]) for run in runs):
        found = [run for run in runs if (run["trained_on"], run["tested_on"]) == pair]
        cells = [_spread([run[figure] for run in found]) for figure in FIGURES]
        rows.append([" → ".join(pair), str(sum(run["plans"] for run in found)), *cells])
    yield markdown_table(["trained on → tested on", "plans", *FIGURES.values()], rows)


def _questions(runs: list[dict]) -> Iterator[str]:
    if not runs:
        return
    yield "### What to ask next\n"
    yield "Log-loss on other traces after so many labelled ones, the next one chosen at random or by expected"
    yield "information; n repetitions, each with a pool and tests of its own. Saved: how many traces fewer"
    yield "the informative choice needs for the mean log-loss that random choice has after so many (negative:"
    yield "more; not reached: not within 20 traces).\n"
    shown = (4, 6, 8, 12, 16, 20)
    rows = []
    for family in dict.fromkeys(run["family"] for run in runs):
        curves = {
            how: [run["log_loss"] for run in runs if (run["family"], run["asked"]) == (family, how)]
            for how in ("random", "informative")
        }
        first, num = runs[0]["first"], min(map(len, curves.values()))
        means = {how: np.mean(curve[:num], axis=0) for how, curve in curves.items()}
        for how, mean in means.items():
            rows.append([f"{family}, {how}", str(num), *(f"{mean[k - first]:.3f}" for k in shown)])
        saved = [_saved(means["random"], means["informative"], k - first) for k in shown]
        rows.append([f"{family}, saved", str(num), *saved])
    yield markdown_table(["family, choice", "n", *(f"{k} traces" for k in shown)], rows)


def _saved(random: np.ndarray, informative: np.ndarray, place: int) -> str:
    reached = np.flatnonzero(informative <= random[place])
    return str(place - int(reached[0])) if len(reached) else "not reached"


def _nodes(runs: list[dict]) -> Iterator[str]:
    if not runs:
        return
    yield "### Scoring a search node\n"
    load = max(run["load"] for run in runs)
    yield "Microseconds of CPU a node, one pinned core, called from Python; least and median of the rounds."
    yield "A relaxed plan of 0 steps shows what the call itself costs. The machine was shared: load"
    yield f"{load:.1f} on two cores.\n"
    rows = [
        [
            run["program"],
            str(run["path"]),
            str(run["tail"]),
            f"{run['least_us']:.2f}",
            f"{run['median_us']:.2f}",
        ]
        for run in runs
    ]
    yield markdown_table(["program", "steps of the path", "of the relaxed plan", "least", "median"], rows)


def _objectives(runs: list[dict]) -> Iterator[str]:
    if not runs:
        return
    yield "### Explicable plans after a second\n"
    limit_s = runs[0]["limit_s"]
    yield "Generated maps, a labeller of 34 simulated traces; J of the plan after at most"
    yield f"{limit_s:g} s of improvement. Target: J within 1 % of the proved optimum on 95 % of 200 maps."
    yield "First plan: by how much its J exceeds the least, on average. Times of the wall clock.\n"
    rows = [
        [
            f"{run['map']}, {run['marks']} rooms, {run['semantics']}, alpha {run['alpha']:g}",
            f"{run['maps']} from {run['seed']}",
            f"{run['proved']} ({run['proved'] / run['maps']:.1%})",
            f"{run['within_close']} ({run['within_close'] / run['maps']:.1%})",
            f"{run['first_excess']:.1%}",
            *_times(run["planning_ms"]),
            f"{run['load']:.1f}",
        ]
        for run in runs
    ]
    head = ["maps", "n and seeds", "proved best", "within 1 %", "first plan", "median, ms", "greatest"]
    yield markdown_table([*head, "load"], rows)


def _first_plans(runs: list[dict]) -> Iterator[str]:
    if not runs:
        return
    yield "### How soon the first explicable plan is there\n"
    yield "From the grounded task to the plan with its scores, one warm process: milliseconds of CPU, and of"
    yield "the wall clock, which at a high load is mostly other programs' time. Targets: 20 ms on 6x6 maps,"
    yield "1 s on 50x50 maps.\n"
    rows = [
        [
            f"{run['map']}, {run['marks']} rooms, {run['semantics']}, alpha {run['alpha']:g}",
            f"{run['maps']} from {run['seed']}",
            str(run["solved"]),
            *_times(run["first_cpu_ms"]),
            *_times(run["first_ms"]),
            f"{run['ground_ms']['median']:.1f}",
            f"{run['load']:.1f}",
        ]
        for run in runs
    ]
    head = ["maps", "n and seeds", "solved", "CPU, median", "greatest", "wall, median", "greatest"]
    yield markdown_table([*head, "grounding, median", "load"], rows)


def _times(found: dict[str, float]) -> tuple[str, str]:
    return f"{found['median']:.1f}", f"{found['max']:.1f}"


def renew(page: Path = PAGE) -> None:
    """Write the labeller's section anew, at the end of the page."""
    before = page.read_text().split(f"\n{HEADING}")[0].rstrip("\n")
    page.write_text(before + "\n\n" + "\n".join(sections()))


if __name__ == "__main__":
    renew()

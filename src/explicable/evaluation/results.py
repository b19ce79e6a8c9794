"""From records to the page of results."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from explicable.evaluation.answers import answer
from explicable.evaluation.experiments import Experiment
from explicable.evaluation.page import Page, Table, write_page
from explicable.evaluation.records import Record

EXPECTED_OUTCOMES = {"solved", "goal reached", "measured"}
"""How a row may end without anybody having to explain it."""

SUMMARY = (
    "Every figure stands with its 95 % interval and its n, and is computed from the records beside this page."
    " All participants are simulated: test instruments, whose word is no evidence about people."
)
SUMMARY_OF_STUDY = (
    "Every figure stands with its 95 % interval and its n, and is computed from the records beside this page."
    " The labeller learned from the traces of a study ({traces}); participants who judge are simulated: test"
    " instruments, whose word is no evidence about people."
)


def make_page(
    experiments: Sequence[Experiment], records: Mapping[str, Sequence[Record]], run: Mapping[str, Any]
) -> Page:
    """Answer every question from its records alone.

    Parameters
    ----------
    experiments
        In the order of the page.
    records
        By experiment.
    run
        What `explicable.evaluation.runner.describe_run` said.
    """
    num_trials = sum(len(experiment.trials()) for experiment in experiments)
    work_s = sum(record["trial_s"] for found in records.values() for record in found)
    facts = {
        "date": run["date"],
        "machine": run["machine"],
        "versions": ", ".join(f"{name} {version}" for name, version in run["versions"].items()),
        "seeds": ", ".join(f"{experiment.name} {experiment.seed}" for experiment in experiments),
        "trials": f"{sum(map(len, records.values()))} done of {num_trials}",
        "duration": _duration(run.get("stretches", ()), work_s),
    }
    sections = tuple(answer(experiment, records[experiment.name]) for experiment in experiments)
    traces = {
        str(cell["traces"]) for experiment in experiments for cell in experiment.cells if cell.get("traces")
    }
    summary = SUMMARY_OF_STUDY.format(traces=", ".join(sorted(traces))) if traces else SUMMARY
    return Page("Results", summary, facts, sections, list_failures(records))


def _duration(stretches: Sequence[Mapping[str, Any]], work_s: float) -> str:
    """Say how long it took by the clock, start by start, and how much work that was.

    Examples
    --------
    >>> _duration([{"workers": "--jobs 2", "trials": 9, "wall_s": 90.0}], 171.0)
    '1.5 minutes (--jobs 2, 9 trials); 2.9 minutes of work, all processes together'
    """
    parts = [f"{s['wall_s'] / 60:.1f} minutes ({s['workers']}, {s['trials']} trials)" for s in stretches]
    return "; ".join([*parts, f"{work_s / 60:.1f} minutes of work, all processes together"])


def list_failures(records: Mapping[str, Sequence[Record]]) -> Table:
    """List the trials that broke, and the rows that ended as none should.

    Examples
    --------
    >>> list_failures({}).rows
    ()
    """
    lines = []
    for name, found in records.items():
        for record in found:
            where = f"{name}, {json.dumps(record['settings'])}, repeat {record['repeat']}"
            if record["outcome"] != "done":
                lines.append((where, record["error"] or "no message"))
            for row in record["rows"]:
                if row.get("outcome", "measured") not in EXPECTED_OUTCOMES:
                    what = ", ".join(str(row[part]) for part in ("map", "plan", "strategy") if part in row)
                    lines.append((f"{where}, {what}", row["outcome"]))
    return Table("failures", "Unexplained failures", ("where", "what"), tuple(lines))


def write_results(
    experiments: Sequence[Experiment], records: Mapping[str, Sequence[Record]], folder: Path
) -> None:
    """Write page, tables and figures beside the records; see `explicable.evaluation.page.write_page`."""
    run = json.loads((folder / "run.json").read_text("utf-8"))
    write_page(make_page(experiments, records, run), folder)

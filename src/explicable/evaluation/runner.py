"""Run experiments, or what of them is not on disk yet, and say with what they were run."""

import json
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from explicable.evaluation.experiments import Experiment
from explicable.evaluation.records import Record, RecordFile, Trial
from explicable.evaluation.workers import run_here, run_on_dask
from explicable.model.files import write_whole

Tell = Callable[[str, int, int], None]
"""Called with the experiment's name, the trials done, and all its trials, whenever a trial ends."""

LIBRARIES = ("explicable", "numpy", "scipy", "scikit-learn", "statsmodels")


def run_experiments(
    experiments: Sequence[Experiment],
    folder: Path,
    *,
    jobs: int = 1,
    scheduler: str | None = None,
    tell: Tell | None = None,
) -> dict[str, list[Record]]:
    """Do all trials of which the folder holds no record, and return all records.

    Interrupted, it can be called again and goes on. The files depend neither on the workers nor on the order
    in which trials ended, but for times.

    Parameters
    ----------
    folder
        Records go to ``records/EXPERIMENT.jsonl`` in it, and what it was run with to ``run.json``.
    jobs
        Processes on this machine.
    scheduler
        Address of a Dask scheduler, whose workers are then used instead.
    tell
        Is told how far it has come.

    Raises
    ------
    UsageError
        If the folder holds records of other experiments of the same name.
    """
    tell = tell or (lambda *_: None)
    files = {experiment.name: RecordFile(_path(folder, experiment.name)) for experiment in experiments}
    missing = {
        experiment.name: files[experiment.name].resume(experiment.trials()) for experiment in experiments
    }
    write_whole(folder / "run.json", json.dumps(describe_run(), indent=2) + "\n")
    records = {}
    for experiment in experiments:
        trials, file = experiment.trials(), files[experiment.name]
        num_done = len(trials) - len(missing[experiment.name])
        tell(experiment.name, num_done, len(trials))
        for line in _run(missing[experiment.name], jobs, scheduler):
            file.append(json.loads(line))
            num_done += 1
            tell(experiment.name, num_done, len(trials))
        records[experiment.name] = file.put_in_order(trials)
    return records


def read_records(experiments: Sequence[Experiment], folder: Path) -> dict[str, list[Record]]:
    """Read the records that a run has left."""
    return {experiment.name: RecordFile(_path(folder, experiment.name)).read() for experiment in experiments}


def describe_run() -> dict[str, Any]:
    """Say when, where and with what experiments are run.

    Examples
    --------
    >>> sorted(describe_run())
    ['date', 'machine', 'versions']
    """
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "machine": f"{_processor()}, {os.cpu_count()} cores, {platform.system()}",
        "versions": {"Python": platform.python_version()} | dict(_versions()),
    }


def _path(folder: Path, name: str) -> Path:
    return folder / "records" / f"{name}.jsonl"


def _run(trials: Sequence[Trial], jobs: int, scheduler: str | None) -> Iterator[bytes]:
    return run_on_dask(trials, scheduler) if scheduler and trials else run_here(trials, jobs)


def _versions() -> Iterator[tuple[str, str]]:
    for name in LIBRARIES:
        try:
            yield name, version(name)
        except PackageNotFoundError:
            yield name, "not installed"


def _processor() -> str:
    """Return the processor's name where the system tells it."""
    listing = Path("/proc/cpuinfo")
    lines = listing.read_text("utf-8").splitlines() if listing.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()

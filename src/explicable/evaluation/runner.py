"""Run experiments, or what of them is not on disk yet, and say with what they were run."""

import json
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter
from typing import Any

from explicable.errors import InputError
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
        Records go to ``records/EXPERIMENT.jsonl`` in it, and what it was run with, and for how long, to
        ``run.json``.
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
    log = _RunLog(folder / "run.json", "a Dask cluster" if scheduler else f"--jobs {jobs}")
    records = {}
    for experiment in experiments:
        trials, file = experiment.trials(), files[experiment.name]
        num_done = len(trials) - len(missing[experiment.name])
        tell(experiment.name, num_done, len(trials))
        for line in _run(missing[experiment.name], jobs, scheduler):
            file.append(json.loads(line))
            num_done += 1
            log.count_trial()
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


class _RunLog:
    """With what experiments are run, and how long it takes: a stretch from each start to its end."""

    def __init__(self, path: Path, workers: str) -> None:
        self._path, self._began = path, perf_counter()
        try:
            earlier = json.loads(path.read_text("utf-8")).get("stretches", []) if path.exists() else []
        except (ValueError, AttributeError) as error:
            raise InputError("not the description of a run", path=path) from error
        self._run = describe_run() | {"stretches": earlier}
        self._stretch: dict[str, Any] = {"workers": workers, "trials": 0, "wall_s": 0.0}
        write_whole(path, json.dumps(self._run, indent=2) + "\n")

    def count_trial(self) -> None:
        """Note that a trial has ended; on the disk at once, since a run may be killed."""
        self._stretch["trials"] += 1
        self._stretch["wall_s"] = round(perf_counter() - self._began, 1)
        run = self._run | {"stretches": [*self._run["stretches"], self._stretch]}
        write_whole(self._path, json.dumps(run, indent=2) + "\n")


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

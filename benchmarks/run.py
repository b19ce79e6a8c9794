"""Runs explicable and its peers side by side and keeps one JSON line a run; `page.py` makes tables of them.

In every experiment the programs take turns on the same task, in an order that rotates from run to run, on one
pinned core. A program that does not solve a task within the limits is not asked again.
"""

import json
import os
import platform
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TextIO

import click
from measure import MIB, Limits
from page import write_page
from rich.progress import MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from solve import solve
from tasks import GROUNDING_TASKS, RATE_TASKS, BenchmarkTask, growing, mixed, read_folder, small, with_labels

from peers import FD_LAZY, HERE, OURS, Peers, Program

ROOT = HERE.parent
EXPERIMENTS = ("planners", "rate", "grounding", "growth", "labelled", "crf")


@dataclass(frozen=True, slots=True)
class Bench:
    """What to run, how often, and where the records go."""

    peers: Peers
    without: tuple[str, ...]
    limits: Limits
    runs: int
    records: TextIO
    progress: Progress
    verdicts: dict[tuple[str, str], dict]

    def record(self, experiment: str, **fields: object) -> None:
        """Keep one record, at once."""
        self.records.write(json.dumps({"experiment": experiment} | fields) + "\n")
        self.records.flush()

    def take_turns(self, experiment: str, programs: list[Program], tasks: list[BenchmarkTask | None]) -> None:
        """Run every program on every task, `runs` times or until it fails."""
        bar = self.progress.add_task(experiment, total=len(tasks))
        for task in tasks:
            name = task.name if task else ""
            failed: set[str] = set()
            for run in range(self.runs):
                turn = run % len(programs)
                for program in programs[turn:] + programs[:turn]:
                    if program.name in failed or run >= (program.most_runs or self.runs):
                        continue
                    self.progress.update(bar, description=f"{experiment}: {name} {program.name}")
                    record = solve(program, task, self.peers, self.limits, self.verdicts)
                    self.record(experiment, run=run, **record)
                    if record["outcome"] != "solved":
                        failed.add(program.name)
            self.progress.advance(bar)
            if not self.progress.console.is_terminal:
                self.progress.console.print(f"{experiment}: {name}: done")
        self.progress.update(bar, description=experiment)

    def able(self, experiment: str, programs: list[Program]) -> list[Program]:
        """Those that manage a small task; the others are recorded as absent, with the reason."""
        able = []
        with TemporaryDirectory(prefix="explicable-bench-") as folder:
            task = small(Path(folder))
            for program in programs:
                if program.name in self.without:
                    self.record("absent", program=program.name, task=experiment, why="left out on request")
                    continue
                record = solve(program, task, self.peers, self.limits, {})
                if record["outcome"] == "solved":
                    able.append(program)
                else:
                    self.record("absent", **record | {"task": experiment})
        return able


def run_experiment(bench: Bench, experiment: str, tasks: list[BenchmarkTask], folder: Path) -> None:
    """Run one of `EXPERIMENTS`; generated tasks go to `folder`."""
    match experiment:
        case "planners":
            bench.take_turns(experiment, bench.able(experiment, bench.peers.planners()), tasks)
        case "rate":
            bench.take_turns(
                experiment, bench.able(experiment, bench.peers.rates()), _named(RATE_TASKS, tasks)
            )
        case "grounding":
            bench.take_turns(
                experiment, bench.able(experiment, bench.peers.grounders()), _named(GROUNDING_TASKS, tasks)
            )
        case "growth":
            programs = [p for p in bench.peers.planners() if p.name in {OURS, FD_LAZY}]
            bench.take_turns(experiment, bench.able(experiment, programs), growing(folder))
        case "labelled":
            bench.take_turns(experiment, bench.peers.labelled(), with_labels(folder, tasks))
        case "crf":
            patient = replace(bench, limits=replace(bench.limits, cpu_s=1200))
            patient.take_turns(experiment, bench.peers.trainers(), [None])


def _named(names: tuple[str, ...], tasks: list[BenchmarkTask]) -> list[BenchmarkTask]:
    return [task for task in tasks if task.name in names] or tasks


def _versions(peers: Peers) -> dict[str, str]:
    frozen = subprocess.run(
        [peers.python, "-m", "pip", "list", "--format=json"], capture_output=True, text=True, check=True
    )
    installed = {p["name"].lower().replace("_", "-"): p["version"] for p in json.loads(frozen.stdout)}
    asked = [line.split("==")[0] for line in (HERE / "peers.txt").read_text().split()]
    return {OURS: version(OURS)} | {name: installed.get(name, "not installed") for name in asked}


def _header(peers: Peers, limits: Limits, runs: int) -> dict:
    models = [
        line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")
    ]
    processor = models[0].split(":")[1].strip() if models else platform.machine()
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return {
        "date": datetime.now(UTC).isoformat(timespec="minutes"),
        "machine": f"{processor}, {os.cpu_count()} cores, {memory / (1 << 30):.0f} GiB, {platform.system()}",
        "python": platform.python_version(),
        "commit": commit.stdout.strip(),
        "load": os.getloadavg()[0],
        "versions": _versions(peers),
        "cpu_limit_s": limits.cpu_s,
        "slow": {p.name: p.most_cpu_s for p in peers.planners() + peers.trainers() if p.most_runs == 1},
        "memory_limit_mib": limits.memory_bytes // MIB,
        "runs": runs,
    }


@contextmanager
def _kept(path: Path) -> Iterator[TextIO]:
    """Open a file that is written aside and put in place at the end, also when interrupted."""
    path.parent.mkdir(parents=True, exist_ok=True)
    aside = path.with_suffix(".partial")
    try:
        with aside.open("w") as file:
            yield file
    finally:
        aside.replace(path)


@click.command()
@click.option(
    "--tasks", type=click.Path(path_type=Path), help="Folder of PDDL tasks; default: generated ones."
)
@click.option("--runs", default=5, show_default=True, help="Runs of each program on each task.")
@click.option(
    "--only", multiple=True, type=click.Choice(EXPERIMENTS), help="Experiments to run; default: all."
)
@click.option("--without", multiple=True, help="Programs to leave out, by name.")
@click.option("--match", default="", help="Only tasks whose name contains this.")
@click.option("--cpu-limit", default=30.0, show_default=True, help="CPU seconds for each run.")
@click.option(
    "--peers",
    "home",
    type=click.Path(path_type=Path),
    default=ROOT / ".venv-bench",
    help="The peers' environment.",
)
@click.option("--records", type=click.Path(path_type=Path), default=HERE / "records" / "benchmarks.jsonl")
@click.option("--page", type=click.Path(path_type=Path), default=ROOT / "docs" / "benchmarks.md")
def main(
    tasks: Path | None,
    runs: int,
    only: tuple[str, ...],
    without: tuple[str, ...],
    match: str,
    cpu_limit: float,
    home: Path,
    records: Path,
    page: Path,
) -> None:
    """Measure explicable and its peers on one core; Ctrl-C keeps what has been measured."""
    peers = Peers(home.resolve())
    limits = Limits(core=max(os.sched_getaffinity(0)), cpu_s=cpu_limit)
    columns = (
        TextColumn("{task.description}"),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with (
        TemporaryDirectory(prefix="explicable-tasks-") as name,
        _kept(records) as file,
        Progress(*columns, speed_estimate_period=600) as progress,
    ):
        folder = Path(name)
        bench = Bench(peers, without, limits, runs, file, progress, {})
        bench.record("header", **_header(peers, limits, runs))
        chosen = [task for task in (read_folder(tasks) if tasks else mixed(folder)) if match in task.name]
        if not chosen:
            raise click.UsageError(f"no tasks in {tasks}")
        try:
            for experiment in only or EXPERIMENTS:
                run_experiment(bench, experiment, chosen, folder)
        except KeyboardInterrupt:
            progress.console.print("Interrupted: the page shows what has been measured.")
    write_page(records, HERE / "notes.md", page)


if __name__ == "__main__":
    main()

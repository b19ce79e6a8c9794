"""`explicable evaluate`: experiments, from their files to tables, figures and a page."""

import signal
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from explicable.cli import EXIT_TRIALS_FAILED
from explicable.cli.extras import require
from explicable.cli.files import INPUT_FILE, OUTPUT_FOLDER
from explicable.cli.printing import echo
from explicable.errors import visible

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

    from explicable.evaluation.runner import Tell


@click.command()
@click.option(
    "--study",
    "studies",
    type=INPUT_FILE,
    multiple=True,
    help="An experiment's file (TOML), in the place of those that come with the package; may be repeated.",
)
@click.option(
    "--traces",
    type=INPUT_FILE,
    help="A study's traces, for the paper's experiment in the place of simulated participants' games.",
)
@click.option(
    "--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes on this machine."
)
@click.option("--dask", "scheduler", metavar="SCHEDULER", help="Use a Dask cluster: tcp://HOST:PORT.")
@click.option("--quick", is_flag=True, help="The same with small numbers, in some minutes.")
@click.option(
    "-o",
    "--out",
    type=OUTPUT_FOLDER,
    help="Folder for records and report. Default: evaluation, or evaluation-quick.",
)
@click.option("--report-only", is_flag=True, help="Run nothing; make the report from the records there are.")
def evaluate(
    studies: tuple[Path, ...],
    traces: Path | None,
    jobs: int,
    scheduler: str | None,
    quick: bool,
    out: Path | None,
    report_only: bool,
) -> int:
    """Run the experiments and write tables, figures and a page from their records.

    With a study's traces, the paper's experiment alone. Interrupted, the same command goes on where it was.
    Participants are simulated: test instruments, not people.
    """
    require("evaluation", "statsmodels", "matplotlib", "joblib")
    from explicable.evaluation.experiments import (
        builtin_experiments,
        experiment_on_traces,
        read_experiment,
    )
    from explicable.evaluation.results import write_results
    from explicable.evaluation.runner import read_records, run_experiments

    if scheduler and jobs > 1:
        raise click.UsageError("--jobs is for this machine, --dask for a cluster: use one of them")
    experiments = [read_experiment(path, quick=quick) for path in studies]
    if traces:
        experiments.append(experiment_on_traces(traces, quick=quick))
    experiments = experiments or builtin_experiments(quick=quick)
    names = [experiment.name for experiment in experiments]
    if len(set(names)) < len(names):
        raise click.UsageError("two studies have the same name")
    folder = out or Path("evaluation-quick" if quick else "evaluation")
    if report_only:
        records = read_records(experiments, folder)
    else:
        with (
            _ended_in_order(),
            _progress(sum(len(experiment.trials()) for experiment in experiments)) as tell,
        ):
            records = run_experiments(experiments, folder, jobs=jobs, scheduler=scheduler, tell=tell)
    write_results(experiments, records, folder)
    num_failed = sum(record["outcome"] == "failed" for rows in records.values() for record in rows)
    echo(f"{folder / 'report.html'}: {sum(map(len, records.values()))} trials, {num_failed} failed")
    return EXIT_TRIALS_FAILED if num_failed else 0


@contextmanager
def _ended_in_order() -> "Iterator[None]":
    """Let SIGTERM end a run as Ctrl-C does, so that no worker stays behind."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _progress(num_trials: int) -> "AbstractContextManager[Tell]":
    """Show how far it has come and how long it will still take, on a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )

    @contextmanager
    def shown() -> "Iterator[Tell]":
        with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
            bar = progress.add_task("", total=num_trials)
            done: dict[str, int] = {}

            def tell(name: str, num_done: int, _: int) -> None:
                done[name] = num_done
                progress.update(bar, description=visible(name), completed=sum(done.values()))

            yield tell

    return shown()

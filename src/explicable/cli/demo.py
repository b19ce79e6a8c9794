"""`explicable demo`: the paper's experiment in small, with a page of pictures."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from explicable.cli.files import INPUT_FILE, OUTPUT_FOLDER
from explicable.cli.printing import echo
from explicable.cli.progress import counting
from explicable.cli.trace_files import naming_traces, read_labelled_traces

if TYPE_CHECKING:
    from explicable.evaluation.demo import Record


@click.command()
@click.option(
    "--out",
    type=OUTPUT_FOLDER,
    default=Path("demo"),
    show_default=True,
    help="Folder for the report, the plans and everything that they were made from.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all chance.")
@click.option(
    "--traces", "traces_file", type=INPUT_FILE, help="Train on these labelled traces, not on simulated ones."
)
def demo(out: Path, seed: int, traces_file: Path | None) -> None:
    """Learn what people expect, then plan for four test maps with regard to it, and without.

    By default the labels come from simulated participants, who are test instruments and no people.
    """
    from explicable.evaluation.demo import NUM_PARTS, run_demo, write_demo

    traces = read_labelled_traces(traces_file) if traces_file else None
    with counting(NUM_PARTS + 1) as tell:
        with naming_traces(*filter(None, [traces_file])):
            result = run_demo(seed, traces=traces, tell=tell)
        tell("drawing")
        write_demo(result, out)
    _print_tables(result.records)
    echo(f"\nThe plans side by side: {out / 'report.html'}")


def _print_tables(records: "tuple[Record, ...]") -> None:
    """Print the paper's two tables: overall, and per scenario."""
    from rich.console import Console
    from rich.table import Table

    from explicable.evaluation.demo import PLAN_TITLES, pool

    overall = Table(
        "plan", "F_paper", "F_robot", "E[F]", "steps", title="All test maps, pooled", title_justify="left"
    )
    for plan_type, title in PLAN_TITLES.items():
        row = pool(records, plan_type)
        overall.add_row(title, *map(_score, (row.f_paper, row.f_robot, row.f_expected)), str(row.num_steps))
    each = Table("map", title="Map by map: F_paper, F_robot, steps", title_justify="left")
    for title in PLAN_TITLES.values():
        each.add_column(title)
    for name in dict.fromkeys(record.map for record in records):
        cells = [
            f"{record.f_paper:.3f}  {record.f_robot:.3f}  {record.num_steps}"
            for record in records
            if record.map == name
        ]
        each.add_row(name, *cells)
    console = Console(width=None if sys.stdout.isatty() else 100)
    console.print(overall, each, sep="\n")


def _score(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"

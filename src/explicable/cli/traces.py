"""`explicable traces`: check and arrange files of labelled traces."""

from pathlib import Path
from typing import Literal

import click

from explicable.cli import EXIT_BAD_INPUT
from explicable.cli.files import (
    INPUT_FILE,
    OUTPUT_FILE,
    OUTPUT_FOLDER,
    TeamProblemPaths,
    team_problem_arguments,
)
from explicable.cli.printing import complain, echo
from explicable.cli.trace_files import find_faults, read_trace_files
from explicable.errors import TraceError

trace_files = click.argument("files", metavar="TRACES...", nargs=-1, required=True, type=INPUT_FILE)


@click.group()
def traces() -> None:
    """Check and arrange files of labelled traces."""


@traces.command()
@trace_files
def check(files: tuple[Path, ...]) -> int:
    """Check that every trace is well formed and that its steps can be executed in its problem."""
    from explicable.labelling import read_traces

    num_faults = 0
    for file in files:
        found = read_traces(file)
        faults = find_faults(file, found)
        if not found:
            faults = [TraceError("there is no trace in it", path=file)]
        for fault in faults:
            complain(fault)
        num_faults += len(faults)
        echo(f"{file}: {len(found)} traces, {len(faults)} faults")
    return EXIT_BAD_INPUT if num_faults else 0


@traces.command()
@trace_files
@click.option("-o", "--output", type=OUTPUT_FILE, required=True, help="Trace file to write.")
def merge(files: tuple[Path, ...], output: Path) -> None:
    """Put several trace files into one."""
    from explicable.labelling import write_traces

    write_traces(output, read_trace_files(*files))


@traces.command()
@trace_files
@click.option("--by", type=click.Choice(["problem", "annotator"]), required=True, help="What to split by.")
@click.option(
    "-o",
    "--output",
    type=OUTPUT_FOLDER,
    required=True,
    help="Folder for the parts.",
)
def split(files: tuple[Path, ...], by: Literal["problem", "annotator"], output: Path) -> None:
    """Split trace files by problem or by annotator."""
    from explicable.labelling import split_traces, write_traces

    groups = split_traces(read_trace_files(*files), by)
    for number, (name, group) in enumerate(groups.items(), start=1):
        path = output / f"{by}-{number:03}.jsonl"
        write_traces(path, group)
        echo(f"{path}: {len(group)} traces, {by} {name}")


@traces.command("import")
@click.argument("steps_file", metavar="STEPS", type=INPUT_FILE)
@team_problem_arguments
@click.option("-o", "--output", type=OUTPUT_FILE, required=True, help="Trace file to write.")
@click.option("--annotator", required=True, help="Who gave the labels.")
@click.option(
    "--origin",
    type=click.Choice(["person", "simulated"]),
    default="person",
    show_default=True,
    help="Whether the annotator is a person or a simulated participant.",
)
@click.option("--explicable", default="true", show_default=True, help="The label of explicable steps.")
@click.option("--inexplicable", default="false", show_default=True, help="The label of inexplicable steps.")
def import_steps(
    paths: TeamProblemPaths,
    steps_file: Path,
    output: Path,
    annotator: str,
    origin: Literal["person", "simulated"],
    explicable: str,
    inexplicable: str,
) -> int:
    """Make a trace file of STEPS: one step a line, its symbols first, its label last.

    A blank line ends a trace. The label ? says that nobody was asked; any other than those two named by the
    options is the name of the task that the step serves, and counts as explicable.
    """
    from explicable.labelling import check_traces, write_traces
    from explicable.labelling.plain import read_plain_traces

    found = read_plain_traces(
        steps_file,
        paths.read(),
        annotator=annotator,
        origin=origin,
        explicable=explicable,
        inexplicable=inexplicable,
    )
    faults = check_traces(found)
    for fault in faults:
        complain(f"{steps_file}, trace {fault.line}: {fault.message}")
    if faults:
        return EXIT_BAD_INPUT
    write_traces(output, found)
    echo(f"{output}: {len(found)} traces")
    return 0

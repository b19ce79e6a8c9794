"""`explicable train`, `label`, `traces`: from labelled traces to a labeller, and what it says of a plan."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli import EXIT_BAD_INPUT
from explicable.cli.files import (
    INPUT_FILE,
    OUTPUT_FILE,
    TeamProblemPaths,
    load_labeller,
    naming_plan,
    read_labelled_traces,
    team_problem_arguments,
)
from explicable.model.plan import format_action

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan

trace_files = click.argument("files", metavar="TRACES...", nargs=-1, required=True, type=INPUT_FILE)


@click.command()
@trace_files
@click.option("-o", "--output", type=OUTPUT_FILE, required=True, help="Write the labeller to this file.")
@click.option("--c1", type=click.FloatRange(min=0), default=0.0, show_default=True, help="L1 penalty.")
@click.option("--c2", type=click.FloatRange(min=0), default=1.0, show_default=True, help="L2 penalty.")
@click.option(
    "--bootstrap",
    type=click.IntRange(min=0),
    default=50,
    show_default=True,
    help="Models that tell how sure the labeller is.",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the bootstrap."
)
def train(files: tuple[Path, ...], output: Path, c1: float, c2: float, bootstrap: int, seed: int) -> None:
    """Learn from the labelled TRACES which steps people find explicable."""
    from explicable.labelling import Labeller

    traces = read_labelled_traces(*files)
    labeller = Labeller.train(traces, c1=c1, c2=c2, num_bootstrap=bootstrap, seed=seed)
    labeller.save(output)
    click.echo(
        f"{output}: trained on {labeller.summary['num_labels']} labels in {len(traces)} traces", err=True
    )


@click.command()
@click.argument("labeller_file", metavar="LABELLER", type=INPUT_FILE)
@team_problem_arguments
@click.argument("plan_file", metavar="PLAN", type=INPUT_FILE)
@click.option("--explain", is_flag=True, help="Show for each step the features that moved its label most.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def label(
    paths: TeamProblemPaths, labeller_file: Path, plan_file: Path, explain: bool, as_json: bool
) -> None:
    """Say how explicable each step of PLAN is, and the plan's scores in all variants."""
    from explicable.model.plan import read_plan

    team_task = paths.ground()
    labeller = load_labeller(labeller_file, team_task.problem)
    with naming_plan(plan_file):
        labelled = labeller.label(team_task, read_plan(plan_file))
    reasons = labeller.explain(labelled) if explain else None
    if as_json:
        click.echo(json.dumps(describe(labelled, reasons)))
    else:
        _print_labels(labelled, reasons)


def describe(
    labelled: "LabelledPlan", reasons: list[list[tuple[str, float]]] | None = None
) -> dict[str, Any]:
    """The object that `label --json` prints."""
    steps = [
        {"action": format_action(action), "explicable": label, "probability": probability}
        for action, label, probability in zip(
            labelled.actions, labelled.labels, labelled.probabilities, strict=True
        )
    ]
    for step, spoken in zip(steps, reasons or (), strict=False):
        step["reasons"] = [{"feature": text, "log_odds": weight} for text, weight in spoken]
    scores: dict[str, Any] = dict(labelled.scores.as_dict())
    if any(labelled.is_robot):
        scores["f_robot_interval_95"] = labelled.interval(0.95)
        scores["f_paper_interval_95"] = labelled.interval(0.95, "paper")
    return {"steps": steps, "scores": scores}


def _print_labels(labelled: "LabelledPlan", reasons: list[list[tuple[str, float]]] | None) -> None:
    for number, action in enumerate(labelled.actions):
        mark = " " if labelled.labels[number] else "!"
        click.echo(f"{mark} {labelled.probabilities[number]:5.3f}  {format_action(action)}")
        for text, weight in reasons[number] if reasons else ():
            click.echo(f"         {weight:+.2f}  {text}")
    click.echo()
    for name, value in labelled.scores.as_dict().items():
        if name.startswith("f_") and not name.endswith("variance") and value is not None:
            click.echo(f"{name:18} {value:.3f}")
    if any(labelled.is_robot):
        low, high = labelled.interval(0.95)
        click.echo(f"{'95 % interval':18} {low:.3f} to {high:.3f} (F of the robots' steps)")


@click.group()
def traces() -> None:
    """Check and arrange files of labelled traces."""


@traces.command()
@trace_files
def check(files: tuple[Path, ...]) -> int:
    """Check that every trace is well formed and that its steps can be executed in its problem."""
    from explicable.labelling import check_traces, read_traces

    num_faults = 0
    for file in files:
        found = read_traces(file)
        faults = check_traces(found, file)
        for fault in faults:
            click.echo(f"explicable: {fault}", err=True)
        num_faults += len(faults)
        click.echo(f"{file}: {len(found)} traces, {len(faults)} faults")
    return EXIT_BAD_INPUT if num_faults else 0


@traces.command()
@trace_files
@click.option("-o", "--output", type=OUTPUT_FILE, required=True, help="Trace file to write.")
def merge(files: tuple[Path, ...], output: Path) -> None:
    """Put several trace files into one."""
    from explicable.labelling import read_traces, write_traces

    write_traces(output, read_traces(*files))


@traces.command()
@trace_files
@click.option("--by", type=click.Choice(["problem", "annotator"]), required=True, help="What to split by.")
@click.option(
    "-o",
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    required=True,
    help="Folder for the parts.",
)
def split(files: tuple[Path, ...], by: str, output: Path) -> None:
    """Split trace files by problem or by annotator."""
    from explicable.labelling import read_traces, split_traces, write_traces

    groups = split_traces(read_traces(*files), by)  # type: ignore[arg-type]  # checked by click
    for number, (name, group) in enumerate(groups.items(), start=1):
        path = output / f"{by}-{number:03}.jsonl"
        write_traces(path, group)
        click.echo(f"{path}: {len(group)} traces, {by} {name}")

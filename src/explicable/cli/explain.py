"""`explicable explain`: why a plan's steps are expected or not, and what the person would have to know."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli.files import INPUT_FILE, TeamProblemPaths, team_problem_arguments
from explicable.model.plan import format_action

if TYPE_CHECKING:
    from explicable.planning import StepExplanation


@click.command()
@click.argument("labeller_file", metavar="LABELLER", type=INPUT_FILE)
@team_problem_arguments
@click.argument("plan_file", metavar="PLAN", type=INPUT_FILE)
@click.option(
    "--threshold",
    type=click.FloatRange(0, 1),
    default=0.5,
    show_default=True,
    help="A step at least so probable is expected.",
)
@click.option(
    "--max-told",
    type=click.IntRange(min=0),
    default=3,
    show_default=True,
    help="Most differences between the two models that are told together.",
)
@click.option(
    "--time-limit", type=click.FloatRange(min=0), default=10.0, show_default=True, help="Seconds for it all."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def explain(
    paths: TeamProblemPaths,
    labeller_file: Path,
    plan_file: Path,
    threshold: float,
    max_told: int,
    time_limit: float,
    as_json: bool,
) -> None:
    """Say of each step of PLAN whether it is expected; if not, why, and the least that would make it so."""
    from explicable.labelling import Labeller
    from explicable.model.grounding import ground_team
    from explicable.model.plan import read_plan
    from explicable.planning import explain as explain_plan

    labeller = Labeller.load(labeller_file)
    steps = explain_plan(
        ground_team(paths.read()),
        labeller,
        read_plan(plan_file),
        threshold=threshold,
        max_told=max_told,
        time_limit_s=time_limit,
    )
    if as_json:
        click.echo(json.dumps({"steps": [describe_step(step) for step in steps]}))
    else:
        for step in steps:
            click.echo(str(step))


def describe_step(step: "StepExplanation") -> dict[str, Any]:
    """What `explain --json` prints of one step."""
    return {
        "action": format_action(step.action),
        "probability": step.probability,
        "finding": step.finding.value,
        "reasons": [{"feature": text, "log_odds": weight} for text, weight in step.reasons],
        "told": [str(difference) for difference in step.told],
        "probability_told": step.probability_told,
        "size_tried": step.size_tried,
    }

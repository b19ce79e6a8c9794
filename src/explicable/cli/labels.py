"""`explicable label`: what a labeller says of a plan."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli.files import (
    INPUT_FILE,
    TeamProblemPaths,
    load_labeller,
    naming_plan,
    read_steps,
    team_problem_arguments,
    warn_of_unfamiliar,
)
from explicable.cli.outcomes import json_option
from explicable.cli.printing import echo
from explicable.model.plan import format_action

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan


@click.command()
@click.argument("labeller_file", metavar="LABELLER", type=INPUT_FILE)
@team_problem_arguments
@click.argument("plan_file", metavar="PLAN", type=INPUT_FILE)
@click.option("--explain", is_flag=True, help="Show for each step the features that moved its label most.")
@json_option
def label(
    paths: TeamProblemPaths, labeller_file: Path, plan_file: Path, explain: bool, as_json: bool
) -> None:
    """Say how explicable each step of PLAN is, and the plan's scores in all variants."""
    team_task = paths.ground()
    labeller = load_labeller(labeller_file, team_task.problem)
    with naming_plan(plan_file, team_task.problem):
        labelled = labeller.label(team_task, read_steps(plan_file, team_task.problem))
    warn_of_unfamiliar(labelled)
    reasons = labeller.explain(labelled) if explain else None
    if as_json:
        echo(json.dumps(describe(labelled, reasons)))
    else:
        _print_labels(labelled, reasons)


def describe(
    labelled: "LabelledPlan", reasons: list[list[tuple[str, float]]] | None = None
) -> dict[str, Any]:
    """The object that `label --json` prints."""
    steps = [
        {
            "action": format_action(action),
            "explicable": label,
            "probability": probability,
            "unfamiliar": unfamiliar,
        }
        for action, label, probability, unfamiliar in zip(
            labelled.actions, labelled.labels, labelled.probabilities, labelled.unfamiliar, strict=True
        )
    ]
    if labelled.task_labels != labelled.labels:
        for step, task in zip(steps, labelled.task_labels, strict=True):
            step["task"] = task if isinstance(task, str) else None
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
        task = labelled.task_labels[number]
        named = f"  {task}" if isinstance(task, str) else ""
        echo(f"{mark} {labelled.probabilities[number]:5.3f}  {format_action(action)}{named}")
        for text, weight in reasons[number] if reasons else ():
            echo(f"         {weight:+.2f}  {text}")
    echo()
    for name, value in labelled.scores.as_dict().items():
        if name.startswith("f_") and not name.endswith("variance") and value is not None:
            echo(f"{name:18} {value:.3f}")
    if any(labelled.is_robot):
        low, high = labelled.interval(0.95)
        echo(f"{'95 % interval':18} {low:.3f} to {high:.3f} (F of the robots' steps)")

"""`explicable explain` and `tell`: what the person would have to know to expect a plan, and telling it."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli.files import (
    INPUT_FILE,
    OUTPUT_FILE,
    FiniteRange,
    TeamProblemPaths,
    load_labeller,
    naming_plan,
    read_steps,
    team_problem_arguments,
)
from explicable.cli.outcomes import exit_code, hand_over, json_option
from explicable.cli.prices import HumanSteps, alpha_option, human_step_options
from explicable.cli.printing import echo, warn
from explicable.cli.progress import working
from explicable.model.plan import format_action

if TYPE_CHECKING:
    from explicable.planning import StepExplanation, ToldPlan


@click.command()
@click.argument("labeller_file", metavar="LABELLER", type=INPUT_FILE)
@team_problem_arguments
@click.argument("plan_file", metavar="PLAN", type=INPUT_FILE)
@click.option(
    "--threshold",
    type=FiniteRange(0, 1),
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
    "--time-limit", type=FiniteRange(min=0), default=10.0, show_default=True, help="Seconds for it all."
)
@json_option
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
    from explicable.planning import explain as explain_plan

    team_task = paths.ground()
    labeller = load_labeller(labeller_file, team_task.problem)
    with naming_plan(plan_file, team_task.problem), working("explaining"):
        steps = explain_plan(
            team_task,
            labeller,
            read_steps(plan_file, team_task.problem),
            threshold=threshold,
            max_told=max_told,
            time_limit_s=time_limit,
        )
    if as_json:
        echo(json.dumps({"steps": [describe_step(step) for step in steps]}))
    else:
        for step in steps:
            echo(str(step))


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


@click.command()
@click.argument("labeller_file", metavar="LABELLER", type=INPUT_FILE)
@team_problem_arguments
@alpha_option
@click.option(
    "--telling-cost", type=float, default=1.0, show_default=True, help="Price of telling one difference."
)
@human_step_options
@click.option(
    "--max-told",
    type=click.IntRange(min=0),
    default=2,
    show_default=True,
    help="Most differences that are tried together.",
)
@click.option(
    "--max-sets",
    type=click.IntRange(min=1),
    default=64,
    show_default=True,
    help="Most sets of differences that are tried: a mental model is grounded for each.",
)
@click.option(
    "--time-limit", type=FiniteRange(min=0), default=10.0, show_default=True, help="Seconds for it all."
)
@click.option("--seed", type=int, default=0, show_default=True, help="Breaks ties.")
@click.option("-o", "--output", type=OUTPUT_FILE, help="Write the plan to this file.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of the plan.")
def tell(
    paths: TeamProblemPaths,
    labeller_file: Path,
    alpha: float,
    telling_cost: float,
    human_steps: HumanSteps,
    max_told: int,
    max_sets: int,
    time_limit: float,
    seed: int,
    output: Path | None,
    as_json: bool,
) -> int:
    """Plan as the person expects, or tell them what they don't know: whichever is cheaper.

    What to tell is a step of the plan, which names the robot that tells.
    """
    from explicable.planning import conform_or_explain

    team_task = paths.ground()
    labeller = load_labeller(labeller_file, team_task.problem)
    with working("weighing what to tell"):
        result = conform_or_explain(
            team_task,
            labeller,
            alpha=alpha,
            telling_cost=telling_cost,
            max_told=max_told,
            max_sets=max_sets,
            time_limit_s=time_limit,
            human_model=human_steps.model(),
            human_step_weight=human_steps.weight,
            seed=seed,
        )
    return print_told(result, output, as_json=as_json)


def print_told(result: "ToldPlan", output: Path | None, *, as_json: bool) -> int:
    """Print a plan that may tell, or write it to a file; return the exit code."""
    if not result.is_complete:
        warn(
            "not all that could be told was tried: `tell` with a larger --max-sets or --time-limit tries more"
        )
    lines = () if result.plan is None else (*result.lines, f"; cost = {result.plan.cost}")
    text = "".join(f"{line}\n" for line in lines)
    hand_over(text, output, describe_told(result) if as_json else None, result.outcome.value)
    return exit_code(result)


def describe_told(result: "ToldPlan") -> dict[str, Any]:
    """The object that `tell --json` prints."""
    plan = result.plan
    return {
        "outcome": result.outcome.value,
        "plan": None if plan is None else [format_action(action) for action in plan.actions],
        "agents": None if plan is None else [step.agent for step in plan.steps],
        "cost": None if plan is None else plan.cost,
        "lines": result.lines,
        "told": [
            {"before_step": t.before_step, "agent": t.agent, "difference": str(t.difference)}
            for t in result.tellings
        ],
        "probabilities": result.probabilities,
        "objective": result.objective,
        "lower_bound": result.lower_bound,
        "objective_untold": result.objective_untold,
        "is_complete": result.is_complete,
    }

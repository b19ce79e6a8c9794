"""`explicable measure` and `rank`: what can be said of plans, whoever made them."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli import EXIT_BAD_INPUT
from explicable.cli.files import (
    INPUT_FILE,
    FiniteRange,
    TeamProblemPaths,
    find_line,
    load_labeller,
    naming_plan,
    read_steps,
    team_problem_arguments,
)
from explicable.cli.outcomes import json_option
from explicable.cli.prices import alpha_option
from explicable.cli.printing import echo
from explicable.cli.progress import working
from explicable.cli.trace_files import read_human_model
from explicable.model.plan import format_action, parse_plan

if TYPE_CHECKING:
    from explicable.model.team import TeamProblem
    from explicable.planning import Measures, RankedPlan

plan_argument = click.argument("plan_file", metavar="PLAN", type=INPUT_FILE)

people_option = click.option(
    "--people",
    "people_file",
    metavar="TRACES",
    type=INPUT_FILE,
    help="Learn from these traces what people do, and say how plausible the plan's human steps are.",
)


@click.command()
@team_problem_arguments
@plan_argument
@click.option(
    "--labeller", "labeller_file", type=INPUT_FILE, help="What people find explicable (see `train`)."
)
@click.option(
    "--expected",
    "expected_files",
    metavar="PLAN",
    type=INPUT_FILE,
    multiple=True,
    help="A plan that the person would expect; can be given again. Distances are to the nearest.",
)
@click.option(
    "--other-goal",
    "other_goals",
    metavar="ATOMS",
    multiple=True,
    help="What else the robots could be after, such as '(at r1 hall)(lit hall)'; can be given again.",
)
@click.option(
    "--temperature",
    type=float,
    default=1.0,
    show_default=True,
    help="Of the observer who is surprised, in the unit of cost.",
)
@click.option(
    "--time-limit",
    type=FiniteRange(min=0),
    default=60.0,
    show_default=True,
    help="Seconds for the exact searches; what is not found out by then is left out.",
)
@people_option
@json_option
def measure(
    paths: TeamProblemPaths,
    plan_file: Path,
    people_file: Path | None,
    labeller_file: Path | None,
    expected_files: tuple[Path, ...],
    other_goals: tuple[str, ...],
    temperature: float,
    time_limit: float,
    as_json: bool,
) -> None:
    """Measure PLAN: how explicable, how far from what is expected, how dear, how surprising it is."""
    from explicable.planning import measure as measure_plan

    team_task = paths.ground()
    labeller = None if labeller_file is None else load_labeller(labeller_file, team_task.problem)
    expected_plans = [read_steps(path, team_task.problem) for path in expected_files]
    for path, plan in zip(expected_files, expected_plans, strict=True):
        with naming_plan(path, team_task.problem):
            team_task.mental.execute(plan)
    with naming_plan(plan_file, team_task.problem), working("measuring"):
        measures = measure_plan(
            team_task,
            read_steps(plan_file, team_task.problem),
            labeller,
            expected_plans,
            human_model=read_human_model(people_file) if people_file else None,
            alternative_goals=[parse_plan(text.replace(")", ")\n"), "--other-goal") for text in other_goals],
            temperature=temperature,
            time_limit_s=time_limit,
        )
    record = describe_measures(measures)
    if as_json:
        echo(json.dumps(record))
        return
    hidden = {"step_probabilities", "goal_probabilities", "predictability"}
    shown = {name: value for name, value in record.items() if value is not None and name not in hidden}
    width = max(map(len, shown))
    for name, value in shown.items():
        echo(f"{name:{width}}  {f'{value:.3f}' if isinstance(value, float) else value}")


def describe_measures(measures: "Measures") -> dict[str, Any]:
    """The object that `measure --json` prints; null where nothing is known, and for what is infinite."""
    labelled, distance = measures.labelled, measures.distance
    predicted, seen = measures.predicted, measures.recognition
    record: dict[str, Any] = {"cost": measures.cost, "reaches_goal": measures.reaches_goal}
    record |= labelled.scores.as_dict() if labelled else {}
    for name in ("actions", "causal_links", "states"):
        record[f"distance_{name}"] = getattr(distance, name) if distance else None
    return record | {
        "f_human": predicted.f_human if predicted else None,
        "human_log_probability": _finite(predicted.log_probability) if predicted else None,
        "cost_gap": _finite(measures.cost_gap),
        "objection": measures.objection,
        "num_impossible": measures.num_impossible,
        "surprise": _finite(measures.surprise),
        "step_probabilities": measures.step_probabilities,
        "legibility": seen.legibility if seen else None,
        "predictability": seen.predictability if seen else None,
        "goal_probabilities": seen.goal_probabilities if seen else None,
        "in_time": measures.in_time,
    }


def _finite(value: float | None) -> float | None:
    return None if value is None or math.isinf(value) else value


@click.command()
@click.argument("labeller_file", metavar="LABELLER", type=INPUT_FILE)
@team_problem_arguments
@click.argument("plan_files", metavar="PLAN...", nargs=-1, required=True, type=INPUT_FILE)
@alpha_option
@people_option
@json_option
def rank(
    paths: TeamProblemPaths,
    labeller_file: Path,
    plan_files: tuple[Path, ...],
    alpha: float,
    people_file: Path | None,
    as_json: bool,
) -> int:
    """Order PLANs, from any planner, by cost and by how explicable they are: the best first.

    What is no plan of the task comes last, with the reason. Exit code 3 if none is.
    """
    from explicable.planning import check_alpha
    from explicable.planning import rank as rank_plans

    check_alpha(alpha)
    team_task = paths.ground()
    labeller = load_labeller(labeller_file, team_task.problem)
    plans = [read_steps(path, team_task.problem) for path in plan_files]
    human_model = read_human_model(people_file) if people_file else None
    ranked = rank_plans(team_task, labeller, plans, alpha, human_model=human_model)
    records = [
        {
            "file": str(plan_files[plan.number]),
            "line": _line_of(plan, plan_files, team_task.problem),
            **describe_ranked(plan),
        }
        for plan in ranked
    ]
    if as_json:
        echo(json.dumps({"alpha": alpha, "plans": records}))
    else:
        for place, record in enumerate(records, start=1):
            echo(_ranked_line(place, record))
    return 0 if any(plan.objection is None for plan in ranked) else EXIT_BAD_INPUT


def describe_ranked(plan: "RankedPlan") -> dict[str, Any]:
    """What `rank --json` prints of one plan."""
    return {
        "objective": plan.objective,
        "cost": plan.cost,
        "scores": plan.labelled.scores.as_dict() if plan.labelled else None,
        "f_human": plan.predicted.f_human if plan.predicted else None,
        "objection": plan.objection,
        "plan": [format_action(action) for action in plan.actions],
    }


def _line_of(plan: "RankedPlan", files: Sequence[Path], problem: "TeamProblem") -> int | None:
    step = plan.failing_step
    return None if step is None else find_line(files[plan.number], step, problem)


def _ranked_line(place: int, record: dict[str, Any]) -> str:
    if record["objection"] is not None:
        line = "" if record["line"] is None else f":{record['line']}"
        return f" -  {record['file']}{line}: no plan: {record['objection']}"
    expected = record["scores"]["f_expected"]
    f = "" if expected is None else f"  E[F] = {expected:.3f}"
    if record["f_human"] is not None:
        f += f"  F_human = {record['f_human']:.3f}"
    return f"{place:2}  {record['file']}: J = {record['objective']:.3f}  cost = {record['cost']}{f}"

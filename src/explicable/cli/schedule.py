"""`explicable schedule`: joint plans in which several agents act at once."""

import math
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
    read_told_steps,
    team_problem_arguments,
)
from explicable.cli.outcomes import failure_code, hand_over, json_option
from explicable.cli.prices import alpha_option
from explicable.cli.printing import warn
from explicable.errors import InputError
from explicable.model.plan import format_action

if TYPE_CHECKING:
    from collections.abc import Sequence

    from explicable.model.durations import Durations
    from explicable.model.schedule import Schedule
    from explicable.model.team import TeamProblem, TeamTask
    from explicable.planning import ScheduledPlan


@click.command()
@team_problem_arguments
@click.argument("plan_file", metavar="[PLAN]", type=INPUT_FILE, required=False)
@click.option(
    "--durations",
    "durations_file",
    metavar="FILE",
    type=INPUT_FILE,
    help="TOML: default, [schemas] and [actions]. Without it each step takes 1.",
)
@click.option(
    "--labeller", "labeller_file", type=INPUT_FILE, help="What people find explicable (see `train`)."
)
@alpha_option
@click.option(
    "--time-limit",
    type=FiniteRange(min=0, min_open=True),
    default=10.0,
    show_default=True,
    help="Seconds for planning.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Breaks ties.")
@click.option("--svg", "svg_file", type=OUTPUT_FILE, help="Draw the schedule into this file.")
@click.option("-o", "--output", type=OUTPUT_FILE, help="Write the schedule to this file, as a temporal plan.")
@json_option
def schedule(
    paths: TeamProblemPaths,
    plan_file: Path | None,
    durations_file: Path | None,
    labeller_file: Path | None,
    alpha: float,
    time_limit: float,
    seed: int,
    svg_file: Path | None,
    output: Path | None,
    as_json: bool,
) -> int:
    """Let the steps of PLAN overlap where they don't interfere; without PLAN, plan for a short makespan.

    Every order that the schedule leaves open is executable and ends in the same state. Exit code: 0 done,
    4 proved unsolvable, 5 limit reached, 3 bad input, 2 wrong usage.
    """
    from explicable.model.durations import Durations, read_durations
    from explicable.model.files import write_whole
    from explicable.model.schedule import format_schedule
    from explicable.planning import check_alpha, plan_schedule, schedule_plan

    check_alpha(alpha)
    durations = read_durations(durations_file) if durations_file else Durations()
    team_task = paths.ground()
    labeller = load_labeller(labeller_file, team_task.problem) if labeller_file else None
    if durations_file is not None:
        _check_names(durations, team_task.problem, durations_file)
    if plan_file is None:
        result = plan_schedule(
            team_task, durations, labeller=labeller, alpha=alpha, time_limit_s=time_limit, seed=seed
        )
    else:
        with naming_plan(plan_file, team_task.problem):
            actions, tellings = read_told_steps(plan_file, team_task.problem)
            result = schedule_plan(
                team_task, actions, durations, labeller=labeller, alpha=alpha, tellings=tellings
            )
        if result.schedule is not None and not _reaches_goal(result.schedule, team_task):
            warn(f"{plan_file}: the plan does not reach the goal")
    if result.schedule is not None and svg_file:
        write_whole(svg_file, _draw(result.schedule, result.probabilities, team_task.problem))
    text = None if result.schedule is None else format_schedule(result.schedule)
    record = describe(result, team_task) if as_json else None
    hand_over(text, output, record, result.outcome.value)
    return 0 if result.schedule is not None else failure_code(result.outcome)


def describe(result: "ScheduledPlan", team_task: "TeamTask") -> dict[str, Any]:
    """The object that `--json` prints."""
    schedule, labelled = result.schedule, result.labelled
    record: dict[str, Any] = {"outcome": result.outcome.value, "schedule": None}
    if schedule is None:
        return record
    record["schedule"] = [
        {
            "start": scheduled.start,
            "duration": scheduled.duration,
            "agent": scheduled.step.agent,
            "action": format_action(scheduled.step.action),
            "after": scheduled.after,
            "explicable": probability,
        }
        for scheduled, probability in zip(schedule.steps, result.probabilities, strict=True)
    ]
    return record | {
        "makespan": schedule.makespan,
        "critical_path": schedule.critical_path,
        "lower_bound": result.lower_bound if math.isfinite(result.lower_bound) else None,
        "reaches_goal": _reaches_goal(schedule, team_task),
        "objective": result.objective,
        "scores": labelled.scores.as_dict() if labelled else None,
        "search_s": result.search_s,
    }


def _reaches_goal(schedule: "Schedule", team_task: "TeamTask") -> bool:
    return team_task.task.is_goal(team_task.task.execute(schedule.actions).states[-1])


def _check_names(durations: "Durations", problem: "TeamProblem", path: Path) -> None:
    """Refuse durations of what no agent can do: they would change nothing, and nobody would notice."""
    from explicable.planning.tellings import telling_schema

    schemas = {action.name for action in problem.composite.domain.actions}
    schemas |= {telling} if (telling := telling_schema(problem)) else set()
    for name in (*durations.schemas, *(action[0] for action in durations.actions)):
        if name not in schemas:
            known = ", ".join(sorted(schemas))
            raise InputError(f"there is no action {name}, only {known}", path=path)


def _draw(schedule: "Schedule", probabilities: "Sequence[float | None]", problem: "TeamProblem") -> str:
    from explicable.planning.gantt import draw_schedule

    return draw_schedule(
        schedule,
        people=[agent.name for agent in problem.agents if agent.kind == "human"],
        probabilities=probabilities,
        title=f"makespan {schedule.makespan:g}",
    )

"""`explicable plan`: a plan for any PDDL task, joint if the domain says which agent owns which action."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import click

from explicable.cli.budgets import Budget, budget_options
from explicable.cli.explain import print_told
from explicable.cli.files import (
    INPUT_FILE,
    MEMORY_SIZE,
    OUTPUT_FILE,
    FiniteRange,
    TeamProblemPaths,
    load_labeller,
    team_problem_arguments,
    warn_of_hopeless,
    warn_of_unfamiliar,
)
from explicable.cli.outcomes import exit_code
from explicable.cli.prices import HumanSteps, human_step_options, improvement_options, show_progress
from explicable.cli.printing import echo

if TYPE_CHECKING:
    from explicable.planning import TeamPlan
    from explicable.search import Algorithm

SCORES = ("f_paper", "f_robot", "f_expected")


@click.command()
@team_problem_arguments
@click.option(
    "--labeller", "labeller_file", type=INPUT_FILE, help="What people find explicable (see `train`)."
)
@click.option(
    "--planner",
    type=click.Choice(["ff", "explicable"]),
    help="ff: without regard to the person. explicable: cheap and expected; needs a labeller."
    " Default: explicable where there is a labeller, else ff.",
)
@click.option(
    "--mode",
    type=click.Choice(["default", "paper"]),
    default="default",
    show_default=True,
    help="paper: Eq. 4 in hill-climbing, the most probable labels, and the first plan is the answer.",
)
@click.option("--alpha", type=float, help="Price of one inexplicable step in the unit of cost. Default: 1.")
@budget_options
@human_step_options
@click.option(
    "--telling-cost",
    type=FiniteRange(min=0),
    help="Let the plan tell the person what they don't know, at this price for each thing (see `tell`).",
)
@improvement_options
@click.option(
    "--search",
    "algorithm",
    type=click.Choice(["default", "ff", "lazy", "eager", "bfws", "astar", "wastar", "anytime"]),
    help="Search algorithm (docs/planning.md). Default: the best known for the planner.",
)
@click.option("--time-limit", type=FiniteRange(min=0), help="Seconds that the search may take.")
@click.option(
    "--memory-limit",
    type=MEMORY_SIZE,
    metavar="SIZE",
    help="What the process may take, such as 1GiB or 500MB, grounding and search alike."
    " Default: most of what the machine and its control group have left.",
)
@click.option(
    "--max-evaluations", type=click.IntRange(min=0), help="How many states the search may evaluate."
)
@click.option("--seed", type=int, default=0, show_default=True, help="Breaks ties.")
@click.option("-o", "--output", type=OUTPUT_FILE, help="Write the plan to this file.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of the plan.")
def plan(
    paths: TeamProblemPaths,
    labeller_file: Path | None,
    planner: str | None,
    mode: str,
    alpha: float | None,
    budget: Budget | None,
    human_steps: HumanSteps,
    telling_cost: float | None,
    improve_time: float,
    gap: float,
    algorithm: "Algorithm | None",
    time_limit: float | None,
    memory_limit: int | None,
    max_evaluations: int | None,
    seed: int,
    output: Path | None,
    as_json: bool,
) -> int:
    """Plan for the PDDL task DOMAIN PROBLEM.

    An action belongs to the robot or human that is its first argument. Exit code: 0 solved, 4 proved
    unsolvable, 5 limit reached, 3 bad input, 2 wrong usage.
    """
    from explicable.model.files import write_whole
    from explicable.model.grounding import ground_team
    from explicable.model.plan import format_plan
    from explicable.planning import (
        check_alpha,
        conform_or_explain,
        plan_as_in_paper,
        plan_classically,
        plan_explicably,
        plan_within_budget,
    )

    price = check_alpha(1.0 if alpha is None else alpha)
    is_plain = labeller_file is None or planner == "ff"
    if planner == "explicable" and labeller_file is None:
        raise click.UsageError(
            "explicable planning needs a labeller: --labeller FILE (see `explicable train`)"
        )
    is_priced = human_steps.weight > 0 or telling_cost is not None
    _refuse(
        is_plain=is_plain,
        is_paper=mode == "paper",
        is_priced=is_priced,
        has_budget=budget is not None,
        has_search=algorithm is not None,
    )
    if budget is not None:
        _check_budget(
            settled=is_plain or mode == "paper" or alpha is not None or algorithm is not None,
            limited=memory_limit is not None or max_evaluations is not None,
        )
    started = time.perf_counter()
    problem = paths.read()
    read = time.perf_counter()
    labeller = None if labeller_file is None else load_labeller(labeller_file, problem)
    loaded = time.perf_counter()
    team_task = warn_of_hopeless(ground_team(problem, memory_limit_bytes=_left_of(memory_limit)))
    grounded = time.perf_counter()
    limits: _Limits = {
        "time_limit_s": time_limit,
        # A third as much again passes through the hands of containers that grow.
        "memory_limit_bytes": left * 3 // 4 if (left := _left_of(memory_limit)) is not None else None,
        "max_evaluations": max_evaluations,
        "seed": seed,
    }
    if labeller is None or is_plain:
        result = plan_classically(team_task, labeller=labeller, algorithm=algorithm or "default", **limits)
    elif mode == "paper":
        result = plan_as_in_paper(team_task, labeller, **limits)
    elif budget is not None:
        result = plan_within_budget(
            team_task, labeller, **budget, search_s=improve_time, time_limit_s=time_limit, seed=seed
        )
    elif telling_cost is not None:
        told = conform_or_explain(
            team_task,
            labeller,
            alpha=price,
            telling_cost=telling_cost,
            improve_s=improve_time,
            time_limit_s=10.0 if time_limit is None else time_limit,
            human_model=human_steps.model(),
            human_step_weight=human_steps.weight,
            seed=seed,
        )
        return print_told(told, output, as_json=as_json)
    else:
        result = plan_explicably(
            team_task,
            labeller,
            alpha=price,
            algorithm=algorithm or "default",
            improve_s=improve_time,
            gap=gap,
            human_model=human_steps.model(),
            human_step_weight=human_steps.weight,
            on_better=show_progress(),
            **limits,
        )
    warn_of_unfamiliar(result.labelled)
    text = format_plan(result.plan.actions, result.plan.cost) if result.plan is not None else None
    if output and text:
        write_whole(output, text)
    if as_json:
        import json

        times = {"read_s": read - started, "ground_s": grounded - loaded, "search_s": result.search_s}
        echo(json.dumps(describe(result, times)))
    elif text:
        if not output:
            echo(text, nl=False)
    else:
        echo(f"no plan: {_reason(result, budget)}", err=True)
    return exit_code(result)


def _refuse(*, is_plain: bool, is_paper: bool, is_priced: bool, has_budget: bool, has_search: bool) -> None:
    """Refuse options that contradict each other."""
    if is_paper and (is_plain or has_search):
        raise click.UsageError("--mode paper plans with a labeller, and settles the search itself")
    if is_priced and (is_plain or is_paper or has_budget):
        raise click.UsageError(
            "human steps and telling are charged in J: that needs a labeller, and neither --mode paper"
            " nor a budget"
        )


class _Limits(TypedDict):
    time_limit_s: float | None
    memory_limit_bytes: int | None
    max_evaluations: int | None
    seed: int


def _check_budget(*, settled: bool, limited: bool) -> None:
    if settled:
        raise click.UsageError(
            "a budget takes the place of --alpha: it needs a labeller, and settles mode and search itself"
        )
    if limited:
        raise click.UsageError("--memory-limit and --max-evaluations are of one search; a budget makes many")


def _reason(result: "TeamPlan", budget: Budget | None) -> str:
    if budget is not None and result.outcome.value == "limit reached":
        return "none found that keeps to the budget"
    return f"{result.outcome.value} ({result.limit})" if result.limit else result.outcome.value


def _left_of(memory_limit: int | None) -> int | None:
    """What a limit on the whole process leaves to what comes next."""
    if memory_limit is None:
        return None
    from explicable.errors import ResourceError
    from explicable.model.memory import resident_memory_bytes

    held = resident_memory_bytes()
    if held >= memory_limit:
        raise ResourceError(
            f"memory limit reached: {memory_limit >> 20} MiB are allowed and {held >> 20} MiB already taken"
        )
    return memory_limit - held


def describe(result: "TeamPlan", times: dict[str, float]) -> dict[str, Any]:
    """The object that `--json` prints."""
    from explicable.model.plan import format_action

    scores = dict.fromkeys(SCORES) if result.labelled is None else result.labelled.scores.as_dict()
    return {
        "outcome": result.outcome.value,
        "limit": result.limit,
        "plan": None if result.plan is None else [format_action(step.action) for step in result.plan.steps],
        "agents": None if result.plan is None else [step.agent for step in result.plan.steps],
        "cost": None if result.plan is None else result.plan.cost,
        "alpha": result.alpha,
        "objective": result.objective,
        "lower_bound": result.lower_bound if result.lower_bound < float("inf") else None,
        "scores": scores,
        "num_unfamiliar": None if result.labelled is None else sum(result.labelled.unfamiliar),
        "f_human": None if result.predicted is None else result.predicted.f_human,
        "human_surprise": None if result.predicted is None else result.predicted.surprise,
        "evaluations": result.evaluations,
        "time": times,
    }

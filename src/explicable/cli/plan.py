"""`explicable plan`: a plan for any PDDL task, joint if the domain says which agent owns which action."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli.budgets import Budget, budget_options
from explicable.cli.explain import print_told
from explicable.cli.files import (
    INPUT_FILE,
    OUTPUT_FILE,
    FiniteRange,
    TeamProblemPaths,
    load_labeller,
    team_problem_arguments,
    warn_of_hopeless,
    warn_of_unfamiliar,
)
from explicable.cli.limits import Limits, SearchLimits, limit_options
from explicable.cli.outcomes import exit_code, hand_over
from explicable.cli.prices import (
    DEFAULT_ALPHA,
    HumanSteps,
    human_step_options,
    improvement_options,
    show_progress,
)

if TYPE_CHECKING:
    from explicable.labelling import Labeller
    from explicable.model.team import TeamTask
    from explicable.planning import TeamPlan, ToldPlan
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
@click.option(
    "--alpha",
    type=float,
    help=f"Price of one inexplicable step in the unit of cost. Default: {DEFAULT_ALPHA:g}.",
)
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
@limit_options
@click.option("-o", "--output", type=OUTPUT_FILE, help="Write the plan to this file.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of the plan.")
def plan(paths: TeamProblemPaths, limits: Limits, output: Path | None, as_json: bool, **wished: Any) -> int:
    """Plan for the PDDL task DOMAIN PROBLEM.

    An action belongs to the robot or human that is its first argument. Exit code: 0 solved, 4 proved
    unsolvable, 5 limit reached, 3 bad input, 2 wrong usage.
    """
    from explicable.model.grounding import ground_team
    from explicable.planning import ToldPlan

    wishes = Wishes(**wished)
    wishes.check(limits)
    started = time.perf_counter()
    problem = paths.read()
    read = time.perf_counter()
    labeller = None if wishes.labeller_file is None else load_labeller(wishes.labeller_file, problem)
    loaded = time.perf_counter()
    team_task = warn_of_hopeless(ground_team(problem, memory_limit_bytes=limits.memory_left_bytes()))
    grounded = time.perf_counter()
    found = _find(team_task, labeller, wishes, limits.of_search())
    if isinstance(found, ToldPlan):
        return print_told(found, output, as_json=as_json)
    times = {"read_s": read - started, "ground_s": grounded - loaded, "search_s": found.search_s}
    return _print(found, times, output, as_json=as_json, has_budget=wishes.budget is not None)


@dataclass(frozen=True, slots=True)
class Wishes:
    """What the plan is to be like, and how it is to be found; its attributes are the options."""

    labeller_file: Path | None
    planner: str | None
    mode: str
    alpha: float | None
    budget: Budget | None
    human_steps: HumanSteps
    telling_cost: float | None
    improve_time: float
    gap: float
    algorithm: "Algorithm | None"

    @property
    def is_plain(self) -> bool:
        """Whether the plan is made without regard to the person."""
        return self.labeller_file is None or self.planner == "ff"

    @property
    def price(self) -> float:
        """What an inexplicable step costs."""
        return DEFAULT_ALPHA if self.alpha is None else self.alpha

    def check(self, limits: Limits) -> None:
        """Refuse options that can't be meant, or not together.

        Raises
        ------
        UsageError
            If alpha is no price.
        click.UsageError
            If options contradict each other.
        """
        from explicable.planning import check_alpha

        check_alpha(self.price)
        is_paper, has_search = self.mode == "paper", self.algorithm is not None
        if self.planner == "explicable" and self.labeller_file is None:
            raise click.UsageError(
                "explicable planning needs a labeller: --labeller FILE (see `explicable train`)"
            )
        if is_paper and (self.is_plain or has_search):
            raise click.UsageError("--mode paper plans with a labeller, and settles the search itself")
        is_priced = self.human_steps.weight > 0 or self.telling_cost is not None
        if is_priced and (self.is_plain or is_paper or self.budget is not None):
            raise click.UsageError(
                "human steps and telling are charged in J: that needs a labeller, and neither --mode paper"
                " nor a budget"
            )
        if self.budget is None:
            return
        if self.is_plain or is_paper or self.alpha is not None or has_search:
            raise click.UsageError(
                "a budget takes the place of --alpha: it needs a labeller, and settles mode and search itself"
            )
        if limits.memory_bytes is not None or limits.max_evaluations is not None:
            raise click.UsageError(
                "--memory-limit and --max-evaluations are of one search; a budget makes many"
            )


def _find(
    team_task: "TeamTask", labeller: "Labeller | None", wishes: Wishes, limits: SearchLimits
) -> "TeamPlan | ToldPlan":
    """Plan in the way that the options ask for."""
    from explicable import planning

    algorithm = wishes.algorithm or "default"
    time_limit_s, seed = limits["time_limit_s"], limits["seed"]
    if labeller is None or wishes.is_plain:
        return planning.plan_classically(team_task, labeller=labeller, algorithm=algorithm, **limits)
    if wishes.mode == "paper":
        return planning.plan_as_in_paper(team_task, labeller, **limits)
    if wishes.budget is not None:
        return planning.plan_within_budget(
            team_task,
            labeller,
            **wishes.budget,
            search_s=wishes.improve_time,
            time_limit_s=time_limit_s,
            seed=seed,
        )
    if wishes.telling_cost is not None:
        return planning.conform_or_explain(
            team_task,
            labeller,
            alpha=wishes.price,
            telling_cost=wishes.telling_cost,
            improve_s=wishes.improve_time,
            time_limit_s=10.0 if time_limit_s is None else time_limit_s,
            human_model=wishes.human_steps.model(),
            human_step_weight=wishes.human_steps.weight,
            seed=seed,
        )
    return planning.plan_explicably(
        team_task,
        labeller,
        alpha=wishes.price,
        algorithm=algorithm,
        improve_s=wishes.improve_time,
        gap=wishes.gap,
        human_model=wishes.human_steps.model(),
        human_step_weight=wishes.human_steps.weight,
        on_better=show_progress(),
        **limits,
    )


def _print(
    result: "TeamPlan", times: dict[str, float], output: Path | None, *, as_json: bool, has_budget: bool
) -> int:
    """Print a plan, or write it to a file; return the exit code."""
    from explicable.model.plan import format_plan

    warn_of_unfamiliar(result.labelled)
    text = format_plan(result.plan.actions, result.plan.cost) if result.plan is not None else None
    record = describe(result, times) if as_json else None
    hand_over(text, output, record, _reason(result, has_budget=has_budget))
    return exit_code(result)


def _reason(result: "TeamPlan", *, has_budget: bool) -> str:
    if has_budget and result.outcome.value == "limit reached":
        return "none found that keeps to the budget"
    return f"{result.outcome.value} ({result.limit})" if result.limit else result.outcome.value


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

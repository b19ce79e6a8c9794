"""`explicable front`: what explicability costs."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli import EXIT_LIMIT, EXIT_UNSOLVABLE
from explicable.cli.budgets import Budget, budget_options
from explicable.cli.extras import require
from explicable.cli.files import (
    INPUT_FILE,
    OUTPUT_FILE,
    OUTPUT_FOLDER,
    FiniteRange,
    TeamProblemPaths,
    load_labeller,
    team_problem_arguments,
)
from explicable.cli.outcomes import json_option
from explicable.cli.printing import echo
from explicable.cli.progress import working
from explicable.model.plan import format_action, format_plan

if TYPE_CHECKING:
    from collections.abc import Sequence

    from explicable.planning import FrontPlan


@click.command()
@click.argument("labeller_file", metavar="LABELLER", type=INPUT_FILE)
@team_problem_arguments
@click.option("--max-alpha", type=float, default=10.0, show_default=True, help="Largest price to look at.")
@click.option(
    "--search-time",
    type=FiniteRange(min=0, min_open=True),
    default=1.0,
    show_default=True,
    help="Seconds for the search at one alpha.",
)
@click.option("--time-limit", type=FiniteRange(min=0), help="Seconds for all searches.")
@budget_options
@click.option(
    "-o",
    "--output",
    type=OUTPUT_FOLDER,
    help="Folder for the table (front.csv) and the plans (plan-1.plan, ...).",
)
@click.option(
    "--plot",
    "plot_file",
    metavar="FILE",
    type=OUTPUT_FILE,
    help="Draw the front: an .svg or .png file. Needs `pip install explicable[evaluation]`.",
)
@json_option
def front(
    paths: TeamProblemPaths,
    labeller_file: Path,
    max_alpha: float,
    search_time: float,
    time_limit: float | None,
    budget: Budget | None,
    output: Path | None,
    plot_file: Path | None,
    as_json: bool,
) -> int:
    """List the plans to which none is preferable in both cost and explicability, the cheapest first.

    With a budget, mark the plan that it chooses. Exit code 4 if there is no plan, 5 if none was found in
    time or none keeps to the budget.
    """
    from explicable.planning import choose
    from explicable.planning import front as find_front

    if plot_file is not None and plot_file.suffix not in {".svg", ".png"}:
        raise click.UsageError("--plot draws .svg or .png files")
    if plot_file is not None:
        require("evaluation", "matplotlib")
    team_task = paths.ground()
    labeller = load_labeller(labeller_file, team_task.problem)
    with working(f"looking for plans, up to {search_time:g} s at each alpha"):
        plans = find_front(
            team_task, labeller, max_alpha=max_alpha, search_s=search_time, time_limit_s=time_limit
        )
    chosen = choose(plans, **budget) if budget is not None else None
    number = next((number for number, found in enumerate(plans) if found is chosen), None)
    records = [describe(found) for found in plans]
    if output is not None:
        _write_files(output, plans, number)
    if plot_file is not None and plans:
        _write_plot(plot_file, plans, chosen)
    if as_json:
        echo(json.dumps({"plans": records, "chosen": number}))
    elif plans:
        echo(_table(plans, number), nl=False)
    if not plans and not team_task.task.goal_reachable:
        echo("no plan: unsolvable", err=True)
        return EXIT_UNSOLVABLE
    if not plans or (budget is not None and chosen is None):
        echo("no plan keeps to the budget" if plans else "no plan found in time", err=True)
        return EXIT_LIMIT
    return 0


def describe(found: "FrontPlan") -> dict[str, Any]:
    """What `front --json` prints of one plan.

    `alpha_to` is null where nothing more was asked; both are for a plan that is best at no alpha.
    """
    return {
        "cost": found.plan.cost,
        "num_inexplicable": found.num_inexplicable,
        "alpha_from": found.alpha_from,
        "alpha_to": found.alpha_to if found.alpha_to is not None and math.isfinite(found.alpha_to) else None,
        "is_proved": found.is_proved,
        "scores": found.labelled.scores.as_dict(),
        "plan": [format_action(action) for action in found.plan.actions],
    }


def _row(number: int, found: "FrontPlan") -> tuple[str, ...]:
    ends = [
        f"{alpha:.4g}" if alpha is not None and math.isfinite(alpha) else ""
        for alpha in (found.alpha_from, found.alpha_to)
    ]
    return (
        str(number),
        str(found.plan.cost),
        str(len(found.plan)),
        f"{found.num_inexplicable:.3f}",
        f"{found.explicability:.3f}",
        *ends,
        "yes" if found.is_proved else "no",
    )


_HEADINGS = ("plan", "cost", "steps", "E[inexplicable]", "E[F]", "alpha from", "to", "proved")


def _table(plans: "Sequence[FrontPlan]", chosen: int | None) -> str:
    rows = [_HEADINGS, *(_row(number, found) for number, found in enumerate(plans, start=1))]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(map(str.rjust, row, widths)) for row in rows]
    if chosen is not None:
        lines[1 + chosen] += "  chosen"
    return "".join(f"{line}\n" for line in lines)


def _write_files(folder: Path, plans: "Sequence[FrontPlan]", chosen: int | None) -> None:
    from explicable.model.files import write_whole

    lines = [",".join((*_HEADINGS, "chosen", "file"))]
    for number, found in enumerate(plans):
        name = f"plan-{number + 1}.plan"
        write_whole(folder / name, format_plan(found.plan.actions, found.plan.cost))
        lines.append(",".join((*_row(number + 1, found), "yes" if number == chosen else "no", name)))
    write_whole(folder / "front.csv", "".join(f"{line}\n" for line in lines))


def _write_plot(path: Path, plans: "Sequence[FrontPlan]", chosen: "FrontPlan | None") -> None:
    from explicable.evaluation.plots import plot_front, to_png, to_svg
    from explicable.model.files import write_whole

    make = to_svg if path.suffix == ".svg" else to_png
    write_whole(path, make(lambda axes: plot_front(plans, axes, chosen=chosen)))

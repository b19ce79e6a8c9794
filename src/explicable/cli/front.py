"""`explicable front`: what explicability costs."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli import EXIT_LIMIT
from explicable.cli.files import INPUT_FILE, OUTPUT_FILE, TeamProblemPaths, team_problem_arguments
from explicable.model.plan import format_action, format_plan

if TYPE_CHECKING:
    from explicable.planning import FrontPlan


@click.command()
@click.argument("labeller_file", metavar="LABELLER", type=INPUT_FILE)
@team_problem_arguments
@click.option("--max-alpha", type=float, default=10.0, show_default=True, help="Largest price to look at.")
@click.option(
    "--search-time",
    type=click.FloatRange(min=0, min_open=True),
    default=1.0,
    show_default=True,
    help="Seconds for the search at one alpha.",
)
@click.option(
    "--max-cost-increase",
    type=float,
    help="Choose the most explicable plan that exceeds the cheapest by no more than this share: 0.1 is 10 %.",
)
@click.option("--min-explicability", type=float, help="Choose a plan whose expected F is at least this.")
@click.option("-o", "--output", type=OUTPUT_FILE, help="Write the chosen plan to this file.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def front(
    paths: TeamProblemPaths,
    labeller_file: Path,
    max_alpha: float,
    search_time: float,
    max_cost_increase: float | None,
    min_explicability: float | None,
    output: Path | None,
    as_json: bool,
) -> int:
    """List the plans that are best at some price of an inexplicable step, the cheapest first.

    With a budget, mark the plan that it chooses. Exit code 5 if there is no plan, or none within the budget.
    """
    from explicable.labelling import Labeller
    from explicable.model.files import write_whole
    from explicable.model.grounding import ground_team
    from explicable.planning import choose
    from explicable.planning import front as find_front

    has_budget = max_cost_increase is not None or min_explicability is not None
    if output is not None and not has_budget:
        raise click.UsageError("--output needs --max-cost-increase or --min-explicability, to choose a plan")
    if has_budget:  # refused before the searches
        choose((), max_cost_increase=max_cost_increase, min_explicability=min_explicability)
    labeller = Labeller.load(labeller_file)
    plans = find_front(ground_team(paths.read()), labeller, max_alpha=max_alpha, search_s=search_time)
    chosen = None
    if has_budget:
        chosen = choose(plans, max_cost_increase=max_cost_increase, min_explicability=min_explicability)
    if output is not None and chosen is not None:
        write_whole(output, format_plan(chosen.plan.actions, chosen.plan.cost))
    if as_json:
        number = next((number for number, found in enumerate(plans) if found is chosen), None)
        click.echo(json.dumps({"plans": [describe(found) for found in plans], "chosen": number}))
    else:
        for found in plans:
            click.echo(_line(found) + ("  chosen" if found is chosen else ""))
    if not plans or (has_budget and chosen is None):
        click.echo("no plan keeps to the budget" if plans else "no plan", err=True)
        return EXIT_LIMIT
    return 0


def describe(found: "FrontPlan") -> dict[str, Any]:
    """What `front --json` prints of one plan; `alpha_to` is null where nothing more was asked."""
    return {
        "cost": found.plan.cost,
        "num_inexplicable": found.num_inexplicable,
        "alpha_from": found.alpha_from,
        "alpha_to": None if math.isinf(found.alpha_to) else found.alpha_to,
        "is_proved": found.is_proved,
        "scores": found.labelled.scores.as_dict(),
        "plan": [format_action(action) for action in found.plan.actions],
    }


def _line(found: "FrontPlan") -> str:
    to = "" if math.isinf(found.alpha_to) else f" to {found.alpha_to:.3g}"
    proved = "" if found.is_proved else "  (not proved best)"
    return (
        f"cost = {found.plan.cost}  E[inexplicable] = {found.num_inexplicable:.3f}"
        f"  E[F] = {found.explicability:.3f}  best for alpha from {found.alpha_from:.3g}{to}{proved}"
    )

"""Compare the explicable planner's default with the plans of others of about the same length.

Run ``python benchmarks/defaults.py -o records/defaults.jsonl``. The labeller learns from 34 simulated traces
of the built-in training maps; the maps are generated, with seeds of their own and in turns by `KINDS`. Each
record is one map: what each planner's plan costs, its expected number of inexplicable steps, E[F], and F of
the most probable labels. Of plans found in a time limit, how good they are hangs on the machine's load.
``python benchmarks/defaults.py --table`` prints what the records come to.
"""

import json
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

import click
import numpy as np
from tables import markdown_table

from explicable.execution import builtin_families, simulate_study
from explicable.first_response import builtin_maps, encode, generate
from explicable.labelling import Labeller
from explicable.model.grounding import ground_team
from explicable.model.team import TeamTask
from explicable.planning import (
    TeamPlan,
    plan_as_in_paper,
    plan_classically,
    plan_explicably,
    plan_within_budget,
)

KINDS: tuple[dict[str, int], ...] = (
    {},
    {"num_hidden": 12},
    {"num_walls": 8, "num_obstacles": 4},
    {"height": 8, "width": 8, "num_marks": 5},
    {"num_marks": 6},
    {"height": 5, "width": 5, "num_marks": 3},
)
"""Of maps: what differs from the study's."""

MUCH = 1.05
"""Plans dearer than the shortest by more than this factor are not compared one by one."""

RECORDS = Path(__file__).parent / "records" / "defaults.jsonl"

LIMIT_S = 20.0
"""For planners that stop at their first plan."""

PLANNERS: dict[str, Callable[[TeamTask, Labeller], TeamPlan]] = {
    "shortest": lambda team, known: plan_classically(
        team, labeller=known, algorithm="anytime", time_limit_s=2.0
    ),
    "ff": lambda team, known: plan_classically(team, labeller=known, algorithm="ff", time_limit_s=LIMIT_S),
    "classical default": lambda team, known: plan_classically(team, labeller=known, time_limit_s=LIMIT_S),
    "paper": lambda team, known: plan_as_in_paper(team, known, time_limit_s=LIMIT_S),
    "explicable": plan_explicably,
    "budget": lambda team, known: plan_within_budget(team, known, max_cost_increase=0.05),
}


def described(found: TeamPlan) -> dict[str, float] | None:
    """Give what is compared of a plan."""
    if found.plan is None or found.labelled is None:
        return None
    scores = found.labelled.scores
    return {
        "cost": found.plan.cost,
        "inexplicable": len(found.plan) * (1 - scores.f_expected),
        "f_expected": scores.f_expected,
        "f_paper": scores.f_paper,
    }


def table(records: list[dict]) -> str:
    """Summarise records: a row for each planner of each setting, means with 95 % bootstrap intervals."""
    settings = sorted({(record["semantics"], record["family"]) for record in records})
    rows = []
    for setting in settings:
        found = [record["plans"] for record in records if (record["semantics"], record["family"]) == setting]
        shortest = [min(plan["cost"] for plan in plans.values() if plan) for plans in found]
        for name in PLANNERS:
            pairs = [(plans, least) for plans, least in zip(found, shortest, strict=True) if plans[name]]
            near = [plans for plans, least in pairs if plans[name]["cost"] <= MUCH * least + 1e-9]
            rows.append(
                [
                    f"{', '.join(setting)}: {name}",
                    str(len(pairs)),
                    mean([plans[name]["f_expected"] for plans, _ in pairs]),
                    mean([plans[name]["f_paper"] for plans, _ in pairs]),
                    mean([100 * (plans[name]["cost"] / least - 1) for plans, least in pairs], digits=1),
                    str(len(near)),
                    *(
                        str(sum(plans["explicable"][score] < plans[name][score] - 1e-9 for plans in near))
                        for score in ("f_expected", "f_paper")
                    ),
                ]
            )
    heads = ["planner", "n", "E[F]", "F", "% longer than the shortest known", "at most 5 % longer"]
    return markdown_table([*heads, "of these, E[F] above the default's", "F above"], rows)


def mean(values: list[float], digits: int = 3) -> str:
    """Return the mean with its 95 % interval, by a bootstrap over maps."""
    rng = np.random.default_rng(0)
    low, high = np.quantile(rng.choice(values, (5000, len(values))).mean(axis=1), [0.025, 0.975])
    return f"{np.mean(values):.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


@click.command()
@click.option("--maps", type=click.IntRange(min=1), default=100, show_default=True)
@click.option("--seed", default=870_000, show_default=True, help="Of the first map; the others follow.")
@click.option(
    "--family", type=click.Choice(["myopic", "mission", "boltzmann"]), default="myopic", show_default=True
)
@click.option("--semantics", type=click.Choice(["persistent", "exclusive"]), default="persistent")
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Append here; default: standard output.",
)
@click.option("--table", "as_table", is_flag=True, help="Print what the records come to, and stop.")
def main(maps: int, seed: int, family: str, semantics: str, output: Path | None, *, as_table: bool) -> None:
    """Write one JSON line for each map."""
    if as_table:
        click.echo(table([json.loads(line) for line in RECORDS.read_text().splitlines()]))
        return
    training = [encode(world, semantics) for world in builtin_maps("training").values()]
    episodes = simulate_study(training, builtin_families()[family], num_traces=34, seed=7, way="mixed")
    labeller = Labeller.train([episode.trace for episode in episodes], num_bootstrap=0)
    with output.open("a") if output else nullcontext() as file:
        for number in range(maps):
            kind = KINDS[number % len(KINDS)]
            world = generate(np.random.default_rng(seed + number), **kind)
            team = ground_team(encode(world, semantics))
            plans = {name: described(planner(team, labeller)) for name, planner in PLANNERS.items()}
            record = {"semantics": semantics, "family": family, "seed": seed + number, "kind": kind}
            click.echo(json.dumps(record | {"plans": plans}), file=file)


if __name__ == "__main__":
    main()

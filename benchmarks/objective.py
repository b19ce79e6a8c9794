"""How good are explicable plans after a second, and how soon is the first: generated maps, 6x6 and 50x50.

Run ``python benchmarks/objective.py``; ``-o records/labeller.jsonl`` appends what was found for the page. The
labeller learns from 34 simulated traces of the built-in training maps, as in the demo; maps have seeds of
their own. Plans that are not proved best within the second are held to the bound that a search of
``--patience`` seconds proves. Times are of the wall clock, in one warm process, and of
first plans also of the CPU, which says more on a machine that others use.
"""

import gc
import json
import os
import time
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from explicable.execution import builtin_families, simulate_study
from explicable.first_response import World, builtin_maps, encode, generate
from explicable.labelling import Labeller
from explicable.model.grounding import ground_team
from explicable.planning import TeamPlan, plan_explicably
from explicable.planning.team_plan import DEFAULT_ALPHA
from explicable.search import search

CLOSE = 0.01
"""A plan is good if its objective exceeds the proved optimum by no more than this share."""

LIMIT_S = 1.0
"""What the search for the best plan is given."""

LARGE, LARGE_MARKS = 50, 8


@dataclass(frozen=True, slots=True)
class Setting:
    """What is the same for all maps."""

    labeller: Labeller
    semantics: str
    alpha: float
    patience_s: float


@dataclass(frozen=True, slots=True)
class First:
    """The first plan on one map, and the seconds it took: to ground the task, to plan, and of that of CPU."""

    plan: TeamPlan
    ground_s: float
    first_s: float
    cpu_s: float


@dataclass(frozen=True, slots=True)
class Run:
    """What came out on one map; an excess is a share of the least objective that is possible."""

    first: First
    planning_s: float
    is_proved: bool
    first_excess: float
    excess: float


def make_setting(semantics: str, alpha: float, patience_s: float) -> Setting:
    """Train the labeller, and plan once, so that all is loaded."""
    training = [encode(world, semantics) for world in builtin_maps("training").values()]
    episodes = simulate_study(training, builtin_families()["myopic"], num_traces=34, seed=0, way="commanded")
    labeller = Labeller.train([episode.trace for episode in episodes], num_bootstrap=0)
    plan_explicably(ground_team(training[0]), labeller, alpha=alpha)
    return Setting(labeller, semantics, alpha, patience_s)


def first_plan(setting: Setting, world: World) -> First:
    """Plan without improvement."""
    gc.collect()  # a pass over what earlier maps have left is no part of this plan
    problem = encode(world, setting.semantics)
    start = time.perf_counter()
    team = ground_team(problem)
    grounded, cpu = time.perf_counter(), time.process_time()
    plan = plan_explicably(team, setting.labeller, alpha=setting.alpha, improve_s=0)
    return First(plan, grounded - start, time.perf_counter() - grounded, time.process_time() - cpu)


def best_plan(setting: Setting, world: World) -> Run:
    """Plan with a second for the improvement, and compare with the least objective that is possible."""
    first = first_plan(setting, world)
    team = ground_team(encode(world, setting.semantics))
    start = time.perf_counter()
    plan = plan_explicably(team, setting.labeller, alpha=setting.alpha, improve_s=LIMIT_S)
    planning_s = time.perf_counter() - start
    bound, is_proved = plan.lower_bound, plan.objective - plan.lower_bound < 1e-6
    if not is_proved:
        bound = search(
            team.task,
            "anytime",
            scorer=setting.labeller.scorer(team),
            alpha=setting.alpha,
            time_limit_s=setting.patience_s,
        ).lower_bound
    return Run(first, planning_s, is_proved, first.plan.objective / bound - 1, plan.objective / bound - 1)


def milliseconds(seconds: list[float]) -> dict[str, float]:
    """Summarise times."""
    median, often, most = np.quantile(seconds, [0.5, 0.95, 1.0]) * 1000
    return {"median": median, "within_95": often, "max": most}


def first_record(size: int, marks: int, found: list[First]) -> dict:
    """Record the first plans on maps of one size."""
    return {
        "experiment": "first plans",
        "map": f"{size}x{size}",
        "marks": marks,
        "maps": len(found),
        "solved": sum(first.plan.plan is not None for first in found),
        "ground_ms": milliseconds([first.ground_s for first in found]),
        "first_ms": milliseconds([first.first_s for first in found]),
        "first_cpu_ms": milliseconds([first.cpu_s for first in found]),
    }


def objective_record(setting: Setting, found: list[Run]) -> dict:
    """Record the best plans on 6x6 maps."""
    return {
        "experiment": "objectives",
        "map": "6x6",
        "marks": 4,
        "maps": len(found),
        "limit_s": LIMIT_S,
        "patience_s": setting.patience_s,
        "proved": sum(run.is_proved for run in found),
        "close": CLOSE,
        "within_close": sum(run.excess <= CLOSE for run in found),
        "first_excess": float(np.mean([run.first_excess for run in found])),
        "planning_ms": milliseconds([run.planning_s for run in found]),
    }


def records(setting: Setting, seeds: range, large_seeds: range) -> Iterator[dict]:
    """Plan for one map after another."""
    runs = [best_plan(setting, generate(np.random.default_rng(seed))) for seed in seeds]
    yield {"seed": seeds.start, **objective_record(setting, runs)}
    yield {"seed": seeds.start, **first_record(6, 4, [run.first for run in runs])}
    worlds = (
        generate(np.random.default_rng(seed), height=LARGE, width=LARGE, num_marks=LARGE_MARKS)
        for seed in large_seeds
    )
    if large_seeds:
        found = [first_plan(setting, world) for world in worlds]
        yield {"seed": large_seeds.start, **first_record(LARGE, LARGE_MARKS, found)}


@click.command()
@click.option("--maps", type=click.IntRange(min=1), default=200, show_default=True, help="6x6 maps.")
@click.option(
    "--large-maps",
    type=click.IntRange(min=0),
    default=20,
    show_default=True,
    help=f"{LARGE}x{LARGE} maps with {LARGE_MARKS} marked rooms.",
)
@click.option("--seed", default=50_000, show_default=True, help="Of the first map; the others follow.")
@click.option("--alpha", default=DEFAULT_ALPHA, show_default=True, help="Price of one inexplicable step.")
@click.option("--semantics", type=click.Choice(["persistent", "exclusive"]), default="persistent")
@click.option("--patience", default=60.0, show_default=True, help="Seconds for a proof after the fact.")
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Append here; default: standard output.",
)
def main(
    maps: int,
    large_maps: int,
    seed: int,
    alpha: float,
    semantics: str,
    patience: float,
    output: Path | None,
) -> None:
    """Write one JSON line for the objectives, and one for the first plans on maps of each size."""
    setting = make_setting(semantics, alpha, patience)
    with output.open("a") if output else nullcontext() as file:
        for record in records(setting, range(seed, seed + maps), range(seed, seed + large_maps)):
            common = {"semantics": semantics, "alpha": alpha, "load": os.getloadavg()[0]}
            click.echo(json.dumps(record | common), file=file)


if __name__ == "__main__":
    main()

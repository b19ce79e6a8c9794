"""How good are explicable plans after a second, and how soon is the first: 200 generated 6x6 maps.

Run ``python benchmarks/objective.py``. The labeller learns from 34 simulated traces of the built-in training
maps, as in the demo; maps have seeds of their own. Plans that are not proved best within the second are held
to the bound that a search of ``--patience`` seconds proves. Times are of the wall clock, on an idle machine.
"""

import os
import time
from collections.abc import Iterator
from dataclasses import dataclass

import click
import numpy as np

from explicable.execution import builtin_families, simulate_study
from explicable.first_response import builtin_maps, encode, generate
from explicable.labelling import Labeller
from explicable.model.grounding import ground_team
from explicable.planning import plan_explicably
from explicable.search import search

CLOSE = 0.01
"""A plan is good if its objective exceeds the proved optimum by no more than this share."""


@dataclass(frozen=True, slots=True)
class Run:
    """What came out on one map; an excess is a share of the least objective that is possible."""

    first_s: float
    planning_s: float
    is_proved: bool
    first_excess: float
    excess: float


def runs(seeds: range, semantics: str, alpha: float, patience_s: float) -> Iterator[Run]:
    """Plan for one map after another."""
    training = [encode(world, semantics) for world in builtin_maps("training").values()]
    episodes = simulate_study(training, builtin_families()["myopic"], num_traces=34, seed=0)
    labeller = Labeller.train([episode.trace for episode in episodes], num_bootstrap=0)
    for seed in seeds:
        team = ground_team(encode(generate(np.random.default_rng(seed)), semantics))
        start = time.perf_counter()
        first = plan_explicably(team, labeller, alpha=alpha, improve_s=0)
        first_s = time.perf_counter() - start
        start = time.perf_counter()
        plan = plan_explicably(team, labeller, alpha=alpha, improve_s=1)
        planning_s = time.perf_counter() - start
        bound, is_proved = plan.lower_bound, plan.objective - plan.lower_bound < 1e-6
        if not is_proved:
            scorer = labeller.scorer(team)
            bound = search(
                team.task, "anytime", scorer=scorer, alpha=alpha, time_limit_s=patience_s
            ).lower_bound
        yield Run(first_s, planning_s, is_proved, first.objective / bound - 1, plan.objective / bound - 1)


@click.command()
@click.option("--maps", default=200, show_default=True, help="Number of maps.")
@click.option("--seed", default=50_000, show_default=True, help="Of the first map; the others follow.")
@click.option("--alpha", default=1.0, show_default=True, help="Price of one inexplicable step.")
@click.option("--semantics", type=click.Choice(["persistent", "exclusive"]), default="persistent")
@click.option("--patience", default=60.0, show_default=True, help="Seconds for a proof after the fact.")
def main(maps: int, seed: int, alpha: float, semantics: str, patience: float) -> None:
    """Print the shares and times."""
    found = list(runs(range(seed, seed + maps), semantics, alpha, patience))

    def share(flags: Iterator[bool]) -> str:
        count = sum(flags)
        return f"{count} of {len(found)} ({count / len(found):.1%})"

    def times(values: list[float]) -> str:
        least, often, most = np.quantile(values, [0.5, 0.95, 1.0]) * 1000
        return f"median {least:.1f} ms, 95 % within {often:.1f} ms, all within {most:.1f} ms"

    print(f"{maps} maps from seed {seed}, {semantics}, alpha {alpha:g}; load {os.getloadavg()[0]:.1f}")
    print(f"first plan: {times([run.first_s for run in found])}")
    print(
        f"  its objective exceeds the least by {np.mean([run.first_excess for run in found]):.2%} on average"
    )
    print(f"best plan, a second for its search: {times([run.planning_s for run in found])}")
    print(f"  proved best within the second: {share(run.is_proved for run in found)}")
    print(f"  within {CLOSE:.0%} of the proved optimum: {share(run.excess <= CLOSE for run in found)}")


if __name__ == "__main__":
    main()

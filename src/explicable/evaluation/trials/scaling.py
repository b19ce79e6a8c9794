"""What planning costs in time and memory as maps, rooms, teams and differences grow."""

from dataclasses import dataclass
from functools import partial
from time import perf_counter

import numpy as np

from explicable.evaluation.records import Row, Seed
from explicable.evaluation.trials.training import TESTING, train, training_traces
from explicable.first_response import encode, generate
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.model.memory import (
    forget_peak_memory,
    peak_memory_bytes,
    resident_memory_bytes,
    return_free_memory,
)
from explicable.planning import plan_classically, plan_explicably

MAX_EVALUATIONS = 100_000
"""Budget of each search, so that none takes the time of all others: FF's may look for minutes on large maps.

A search that found no plan within it has the cost None, and its time is what the budget took.
"""


@dataclass(frozen=True, slots=True)
class Settings:
    """What a trial depends on.

    Parameters
    ----------
    side
        Cells along each side of a map, its border aside.
    num_marks, num_robots
        Rooms, robots.
    num_hidden
        Hidden obstacles: how far the two models differ; negative: as usual for the size.
    num_maps
        Maps to plan for.
    """

    side: int = 6
    num_marks: int = 4
    num_robots: int = 1
    num_hidden: int = -1
    num_maps: int = 2


def measure(settings: Settings, seed: Seed) -> list[Row]:
    """Plan for each map, classically and explicably: one row a map."""
    labeller = train(training_traces(seed, "myopic", "exclusive", 34))
    rows = []
    for number in range(settings.num_maps):
        world = generate(
            np.random.default_rng((*seed, TESTING, number)),
            height=settings.side,
            width=settings.side,
            num_marks=settings.num_marks,
            num_robots=settings.num_robots,
            num_hidden=None if settings.num_hidden < 0 else settings.num_hidden,
        )
        return_free_memory()
        forget_peak_memory()
        held_bytes = resident_memory_bytes()
        began = perf_counter()
        team = ground_team(encode(world, "exclusive"))
        ground_s = perf_counter() - began
        began = perf_counter()
        TeamFeatures(team)
        tables_s = perf_counter() - began
        row: Row = {
            "map": f"{settings.side}-{seed[1]}-{number}",
            "num_operators": team.task.num_operators,
            "ground_s": round(ground_s, 6),
            "tables_s": round(tables_s, 6),
        }
        for name, plan in (
            ("ff", partial(plan_classically, algorithm="ff")),
            ("default", plan_classically),
            ("explicable", partial(plan_explicably, labeller=labeller, improve_s=0)),
        ):
            began = perf_counter()
            found = plan(team, max_evaluations=MAX_EVALUATIONS)
            row |= {
                f"{name}_plan_s": round(perf_counter() - began, 6),
                f"{name}_evaluations": found.evaluations,
                f"{name}_cost": None if found.plan is None else found.plan.cost,
            }
            row["outcome"] = found.outcome.value
        rows.append(row | {"memory_bytes": max(0, peak_memory_bytes() - held_bytes)})
    return rows

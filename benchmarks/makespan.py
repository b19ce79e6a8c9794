"""How much sooner a team is done that acts at once, and how far from the lower bound.

Run ``python benchmarks/makespan.py``: one record a map, kept in `records/`, then the rows of the table in
docs/schedules.md, made of the records alone. Generated first-response maps with two robots and two people;
each step takes 1.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from explicable.first_response import encode, generate
from explicable.model.files import write_whole
from explicable.model.grounding import ground_team
from explicable.planning import plan_schedule, schedule_plan
from explicable.search import search

RECORDS = Path(__file__).parent / "records" / "makespan.jsonl"
SETTINGS = ((6, 4, 2.0), (4, 3, 5.0), (4, 2, 5.0))
"""Cells a side, marked rooms, seconds a map."""


def measure(seed, side, marks, limit_s):
    world = generate(np.random.default_rng(seed), height=side, width=side, num_marks=marks, num_robots=2)
    team_task = ground_team(encode(world, num_people=2))
    task = team_task.task
    actions = tuple(map(task.action, search(task).operators))
    planned = plan_schedule(team_task, time_limit_s=limit_s)
    return {
        "side": side,
        "marks": marks,
        "time_limit_s": limit_s,
        "seed": seed,
        "num_steps": len(actions),
        "deordered": schedule_plan(team_task, actions).schedule.makespan,
        "makespan": planned.schedule.makespan,
        "lower_bound": planned.lower_bound,
        "num_nodes": planned.num_nodes,
    }


def mean_with_interval(values, rng):
    values = np.array(values)
    means = values[rng.integers(len(values), size=(2000, len(values)))].mean(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return f"{values.mean():.2f} [{low:.2f}, {high:.2f}]"


def row(records):
    """Make a row of the table."""
    rng = np.random.default_rng(0)
    cells = [f"{records[0]['side']}x{records[0]['side']}, {records[0]['marks']} marks"]
    cells.append(f"{records[0]['time_limit_s']:g} s")
    for name, over in (
        ("deordered", "num_steps"),
        ("makespan", "num_steps"),
        ("makespan", "deordered"),
        ("makespan", "lower_bound"),
    ):
        cells.append(mean_with_interval([record[name] / record[over] for record in records], rng))
    num_proved = sum(record["makespan"] <= record["lower_bound"] + 1e-9 for record in records)
    return f"| {' | '.join(cells)} | {num_proved} of {len(records)} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maps", type=int, default=20, help="of each kind")
    parser.add_argument("--seed", type=int, default=90_000, help="of the first map")
    arguments = parser.parse_args()
    seeds = range(arguments.seed, arguments.seed + arguments.maps)
    records = [measure(seed, *setting) for setting in SETTINGS for seed in seeds]
    write_whole(RECORDS, "".join(json.dumps(record) + "\n" for record in records))
    for setting in SETTINGS:
        print(row([r for r in records if (r["side"], r["marks"], r["time_limit_s"]) == setting]))


if __name__ == "__main__":
    main()

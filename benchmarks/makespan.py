"""How much sooner a team is done that acts at once, and how far from the lower bound.

Run ``python benchmarks/makespan.py``: one record a map, then a summary, read back from
the records. Generated first-response maps with several robots and people; each step takes 1.
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

RECORDS = Path(__file__).parents[1] / "build" / "benchmarks" / "makespan.jsonl"


def measure(seed, arguments):
    world = generate(
        np.random.default_rng(seed),
        height=arguments.side,
        width=arguments.side,
        num_marks=arguments.marks,
        num_robots=arguments.robots,
    )
    team_task = ground_team(encode(world, num_people=arguments.people))
    task = team_task.task
    actions = tuple(map(task.action, search(task).operators))
    planned = plan_schedule(team_task, time_limit_s=arguments.time_limit)
    return {
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


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name, default in (("maps", 20), ("seed", 90_000), ("side", 6), ("marks", 4), ("robots", 2)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--people", type=int, default=2)
    parser.add_argument("--time-limit", type=float, default=2.0, help="seconds a map")
    parser.add_argument("--out", type=Path, default=RECORDS)
    arguments = parser.parse_args()
    seeds = range(arguments.seed, arguments.seed + arguments.maps)
    records = [{**vars(arguments), "out": None, **measure(seed, arguments)} for seed in seeds]
    write_whole(arguments.out, "".join(json.dumps(record) + "\n" for record in records))
    rows = [json.loads(line) for line in arguments.out.read_text().splitlines()]
    rng = np.random.default_rng(0)
    print(f"{len(rows)} maps; means, 95 % bootstrap intervals over maps")
    for name, over in (
        ("deordered", "num_steps"),
        ("makespan", "num_steps"),
        ("makespan", "deordered"),
        ("makespan", "lower_bound"),
    ):
        print(f"{name} / {over}: {mean_with_interval([row[name] / row[over] for row in rows], rng)}")
    print(f"least makespan proved: {sum(row['makespan'] <= row['lower_bound'] + 1e-9 for row in rows)}")


if __name__ == "__main__":
    main()

"""How well a labeller of 34 traces predicts F on maps and of participants that it has never seen.

Run ``python benchmarks/label_quality.py --sets 20``: for each of so many training sets (16 generated maps, 34
traces of 9 simulated participants) of each family it trains a labeller, and lets it predict, before each is
seen, plans that new participants of every family play and label on new maps. It keeps one JSON line for each
training set and pair of families. Simulated participants are test instruments: the figures say nothing about
people.
"""

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from explicable.execution import builtin_families, prepare, simulate, simulate_study
from explicable.first_response import encode, generate
from explicable.labelling import Labeller, Trace
from explicable.labelling.features import TeamFeatures
from explicable.labelling.quality import label_quality
from explicable.labelling.score import score_labels
from explicable.model.grounding import ground_team

NUM_MAPS, NUM_TRACES = 16, 34


def training_traces(family: str, seed: int, way: str) -> list[Trace]:
    """Play a whole study on generated maps."""
    maps = [encode(generate(np.random.default_rng((seed, 0, number)))) for number in range(NUM_MAPS)]
    episodes = simulate_study(maps, builtin_families()[family], num_traces=NUM_TRACES, seed=seed, way=way)
    return [episode.trace for episode in episodes]


def held_out_traces(family: str, seed: int, num_plans: int) -> Iterator[Trace]:
    """Let each of `num_plans` new participants play one new map."""
    for number in range(num_plans):
        setting = prepare(encode(generate(np.random.default_rng((seed, 1, number)))))
        participant = builtin_families()[family].draw(1000 + number, np.random.default_rng((seed, 2, number)))
        yield simulate(setting, participant, np.random.default_rng((seed, 3, number))).trace


def predict(labeller: Labeller, plans: list[tuple[TeamFeatures, Trace]]) -> dict:
    """Compare what the labeller predicts with what the participants said."""
    found: dict[str, list] = {name: [] for name in ("robot", "paper", "in_95", "in_90", "width")}
    labels, probabilities = [], []
    for team, trace in plans:
        plan = labeller.label(team, trace.actions)
        given = [step.is_explicable for step in trace.steps]
        observed = score_labels(given, plan.is_robot)
        found["robot"].append(abs(plan.scores.f_robot_expected - observed.f_robot))
        found["paper"].append(abs(plan.scores.f_expected - observed.f_paper))
        for level in (95, 90):
            low, high = plan.interval(level / 100)
            found[f"in_{level}"].append(low - 1e-9 <= observed.f_robot <= high + 1e-9)
        low, high = plan.interval()
        found["width"].append(high - low)
        labels += given
        probabilities += plan.probabilities
    quality = label_quality(labels, probabilities)
    return {
        "plans": len(plans),
        "steps": quality.num_steps,
        "mae_robot": float(np.mean(found["robot"])),
        "mae_all_steps": float(np.mean(found["paper"])),
        "covered_95": float(np.mean(found["in_95"])),
        "covered_90": float(np.mean(found["in_90"])),
        "width_95": float(np.mean(found["width"])),
        "log_loss": quality.log_loss,
        "base_log_loss": quality.base_log_loss,
        "auc": quality.auc,
        "calibration_error": quality.calibration.error,
    }


def main() -> None:
    """Write one line for each training set and pair of families."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=20, help="training sets of each family")
    parser.add_argument("--plans", type=int, default=20, help="held-out plans of each family, for each set")
    parser.add_argument("--seed", type=int, default=500, help="of the first set")
    parser.add_argument("--families", nargs="+", default=list(builtin_families()))
    parser.add_argument("--way", default="commanded", help="how the training traces are played")
    parser.add_argument("-o", "--output", type=Path, help="append here; default: standard output")
    arguments = parser.parse_args()
    with arguments.output.open("a") if arguments.output else sys.stdout as file:
        for seed in range(arguments.seed, arguments.seed + arguments.sets):
            plans = {
                family: [
                    (TeamFeatures(ground_team(trace.problem)), trace)
                    for trace in held_out_traces(family, seed, arguments.plans)
                ]
                for family in arguments.families
            }
            for family in arguments.families:
                labeller = Labeller.train(training_traces(family, seed, arguments.way), seed=seed)
                for other in arguments.families:
                    record = {"experiment": "labels", "trained_on": family, "tested_on": other, "seed": seed}
                    record |= {"way": arguments.way} | predict(labeller, plans[other])
                    print(json.dumps(record), file=file, flush=True)


if __name__ == "__main__":
    main()

"""Scoring a search node, path and relaxed plan: this package's incremental scorer against CRFsuite.

Run ``python benchmarks/node_scoring.py``, best pinned to a core (``taskset -c 1``). It keeps a JSON line for
each program and path length, with microseconds of CPU time a node, for a relaxed plan of 20 steps and two
labels: the least and the median of many rounds, since whatever else runs on the machine only adds. CRFsuite
tags the whole sequence anew, as a search without contexts must; its features are made beforehand. Both are
called from Python, which costs the scorer a time that a search does not pay: that of a call without steps.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from statistics import median

import numpy as np
import pycrfsuite

from explicable.execution import builtin_families, simulate_study
from explicable.first_response import builtin_maps, encode
from explicable.labelling.features import TeamFeatures
from explicable.labelling.labeller import Labeller
from explicable.model.grounding import ground_team

TAIL = 20


def microseconds(call: Callable[[], object], repetitions: int, rounds: int) -> dict[str, float]:
    """Return the CPU time of a call: the least and the median of the rounds."""
    times = []
    for _ in range(rounds):
        start = time.process_time()
        for _ in range(repetitions):
            call()
        times.append((time.process_time() - start) / repetitions * 1e6)
    return {"least_us": min(times), "median_us": median(times)}


def train_crfsuite(features: list[list[tuple[str, ...]]], path: Path) -> pycrfsuite.Tagger:
    """Train CRFsuite on the same features, every third step being inexplicable."""
    trainer = pycrfsuite.Trainer("lbfgs", verbose=False)
    for rows in features:
        trainer.append(
            pycrfsuite.ItemSequence([list(row) for row in rows]), ["ny"[n % 3 > 0] for n in range(len(rows))]
        )
    trainer.train(str(path))
    tagger = pycrfsuite.Tagger()
    tagger.open(str(path))
    return tagger


def main() -> None:
    """Write one line for each path length and program."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=40)
    parser.add_argument("-o", "--output", type=Path, help="append here; default: standard output")
    arguments = parser.parse_args()
    with arguments.output.open("a") if arguments.output else sys.stdout as file:
        for record in measure(arguments.rounds):
            load = os.getloadavg()[0]
            print(
                json.dumps({"experiment": "nodes", "load": load, "rounds": arguments.rounds} | record),
                file=file,
            )


def measure(rounds: int) -> Iterator[dict]:
    """Score nodes of random walks, by both programs."""
    problems = [encode(world, "exclusive") for world in list(builtin_maps().values())[:4]]
    episodes = simulate_study(problems, builtin_families()["myopic"], num_traces=8, way="commanded")
    labeller = Labeller.train([episode.trace for episode in episodes], num_bootstrap=0)
    team = TeamFeatures(ground_team(problems[0]))
    task, rng = team.task, np.random.default_rng(0)
    robots = [operator for operator in range(task.num_operators) if not team.tables.is_human(operator)]
    with tempfile.TemporaryDirectory() as folder:
        rows = [labeller.label(ground_team(e.trace.problem), e.trace.actions).features for e in episodes]
        tagger = train_crfsuite(rows, Path(folder) / "model")
        for length in (50, 500):
            operators, states = [], [task.initial_state]
            for _ in range(length):
                operators.append(int(rng.choice(task.applicable(states[-1]))))
                states.append(task.successor(states[-1], operators[-1]))
            tail = rng.choice(robots, size=TAIL).tolist()
            sequence = pycrfsuite.ItemSequence([list(row) for row in team.extract(operators + tail, states)])
            for expected in (True, False):
                scorer = labeller.scorer(team, expected=expected)
                context = scorer.root(states[0])
                for place, operator in enumerate(operators):
                    context = scorer.extend(context, operator, states[place], states[place + 1])
                for steps in (tail, []):
                    call = partial(scorer.score, context, states[-1], steps)
                    program = "explicable, expected" if expected else "explicable, Viterbi"
                    yield {"program": program, "path": length, "tail": len(steps)} | microseconds(
                        call, 2000, rounds
                    )
            found = microseconds(partial(tagger.tag, sequence), 50, max(rounds // 4, 3))
            yield {"program": "CRFsuite", "path": length, "tail": TAIL} | found


if __name__ == "__main__":
    main()

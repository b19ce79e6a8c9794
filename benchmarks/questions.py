"""How many traces asking for the most informative plan saves against asking for a random one.

Run ``python benchmarks/questions.py``. In each repetition simulated participants of one family play generated
maps; from a pool of their traces one after the other is chosen to be labelled, and the labeller's log-loss on
other traces is kept after each: one JSON line for each repetition and way of asking. Both ways begin with the
same two traces. Simulated participants are test instruments: the figures say nothing about people.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

from explicable.execution.episodes import simulate_study
from explicable.execution.participants import builtin_families
from explicable.first_response.encoding import encode
from explicable.first_response.generator import generate
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.learning import CLASSES, TrainingData
from explicable.labelling.quality import label_quality
from explicable.labelling.questions import rank_questions
from explicable.labelling.uncertainty import fit_bootstrap


def log_loss(crf, plans, answers):
    """Return the mean log-loss over robots' steps; human steps have no features and are clamped."""
    clamp = [[None if step else True for step in plan] for plan in plans]
    tables = crf.predict_marginals(plans, clamp)
    pairs = [
        (label, table[number, 0])
        for plan, row, table in zip(plans, answers, tables, strict=True)
        for number, (step, label) in enumerate(zip(plan, row, strict=True))
        if step
    ]
    return label_quality([label for label, _ in pairs], [probability for _, probability in pairs]).log_loss


def choose(how, crf, data, labelled, pool, rng):
    rest = [plan for plan in pool if plan not in labelled]
    if how == "random":
        return int(rng.choice(rest))
    X, y = [data.features[k] for k in labelled], [data.labels[k] for k in labelled]
    may_ask = [[bool(step) for step in data.features[k]] for k in rest]
    clamp = [[None if flag else True for flag in row] for row in may_ask]
    models = fit_bootstrap(crf, X, y, rng, 8)
    return rest[
        rank_questions(models, [data.features[k] for k in rest], clamp=clamp, may_ask=may_ask)[0].plan
    ]


def repetition(family, seed, arguments):
    """Yield a record for each way of asking."""
    rng = np.random.default_rng((seed, 0))
    num_traces = arguments.pool + arguments.tests
    problems = [encode(generate(rng)) for _ in range(num_traces)]
    data = TrainingData()
    for episode in simulate_study(
        problems, builtin_families()[family], num_traces=num_traces, seed=seed, way="commanded"
    ):
        data.add(episode.trace)
    pool = range(arguments.pool)
    plans, answers = data.features[arguments.pool :], data.labels[arguments.pool :]
    crf = ConditionalRandomField(classes=CLASSES, tolerance=1e-6)
    first = [int(k) for k in np.random.default_rng((seed, 1)).permutation(arguments.pool)[:2]]
    for how in ("random", "informative"):
        draws, labelled, losses = np.random.default_rng((seed, 2)), list(first), []
        while True:
            crf.fit([data.features[k] for k in labelled], [data.labels[k] for k in labelled])
            losses.append(log_loss(crf, plans, answers))
            if len(labelled) >= arguments.traces:
                break
            labelled.append(choose(how, crf, data, labelled, pool, draws))
        yield {"asked": how, "first": len(first), "log_loss": [round(loss, 5) for loss in losses]}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--families", nargs="+", default=list(builtin_families()))
    parser.add_argument("--pool", type=int, default=60, help="traces that may be labelled")
    parser.add_argument("--tests", type=int, default=40, help="other traces, for the log-loss")
    parser.add_argument("--traces", type=int, default=20, help="how many are labelled")
    parser.add_argument("--repetitions", type=int, default=10)
    parser.add_argument("--seed", type=int, default=700, help="of the first repetition")
    parser.add_argument("-o", "--output", type=Path, help="append here; default: standard output")
    arguments = parser.parse_args()
    with arguments.output.open("a") if arguments.output else sys.stdout as file:
        for seed in range(arguments.seed, arguments.seed + arguments.repetitions):
            for family in arguments.families:
                for found in repetition(family, seed, arguments):
                    sizes = {"pool": arguments.pool, "tests": arguments.tests}
                    record = {"experiment": "questions", "family": family, "seed": seed} | sizes | found
                    print(json.dumps(record), file=file, flush=True)


if __name__ == "__main__":
    main()

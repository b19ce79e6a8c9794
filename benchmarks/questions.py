"""How many traces asking for the most informative plan saves against asking for a random one.

Run ``python benchmarks/questions.py``. Simulated participants of one family play generated maps; from a pool
of their traces one after the other is chosen to be labelled, and the labeller's log-loss on other traces is
printed after each. Simulated participants are test instruments: the figures say nothing about people.
"""

import argparse
import json

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


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--family", default="myopic")
    parser.add_argument(
        "--pool", type=int, default=100, help="traces that may be labelled; half as many test"
    )
    parser.add_argument("--traces", type=int, default=14, help="how many are labelled")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    num_traces = arguments.pool + arguments.pool // 2
    problems = [encode(generate(rng)) for _ in range(num_traces)]
    family = builtin_families()[arguments.family]
    data = TrainingData()
    for episode in simulate_study(problems, family, num_traces=num_traces, seed=arguments.seed):
        data.add(episode.trace)
    pool = range(arguments.pool)
    plans, answers = data.features[arguments.pool :], data.labels[arguments.pool :]
    crf = ConditionalRandomField(classes=CLASSES, tolerance=1e-6)
    for how in ("random", "informative"):
        curves = []
        for repetition in range(arguments.repetitions):
            draws = np.random.default_rng((arguments.seed, repetition))
            labelled, curve = [int(k) for k in draws.permutation(arguments.pool)[:2]], []
            while True:
                crf.fit([data.features[k] for k in labelled], [data.labels[k] for k in labelled])
                curve.append(log_loss(crf, plans, answers))
                if len(labelled) >= arguments.traces:
                    break
                labelled.append(choose(how, crf, data, labelled, pool, draws))
            curves.append(curve)
        means = np.mean(curves, axis=0).round(4).tolist()
        print(json.dumps({"asked": how, "log_loss_by_traces": dict(enumerate(means, start=2))}), flush=True)


if __name__ == "__main__":
    main()

"""Scoring a search node, path and relaxed plan: this package's incremental scorer against CRFsuite.

Run ``python benchmarks/node_scoring.py``. It prints microseconds of CPU time a node, two labels, relaxed plan
of 20 steps. CRFsuite tags the whole sequence anew, as a search without contexts must; its features are made
beforehand. Both are called from Python, which costs the scorer a time that a search does not pay.
"""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pycrfsuite

from explicable.execution import builtin_families, simulate_study
from explicable.first_response import builtin_maps, encode
from explicable.labelling.features import TeamFeatures
from explicable.labelling.labeller import Labeller
from explicable.model.grounding import ground_team

TAIL = 20


def microseconds(call: Callable[[], object], repetitions: int) -> float:
    """Return the CPU time of a call, the best of five rounds."""
    best = float("inf")
    for _ in range(5):
        start = time.process_time()
        for _ in range(repetitions):
            call()
        best = min(best, (time.process_time() - start) / repetitions)
    return best * 1e6


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
    """Print one line a path length."""
    problems = [encode(world, "exclusive") for world in list(builtin_maps().values())[:4]]
    episodes = simulate_study(problems, builtin_families()["myopic"], num_traces=8)
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
            peer = microseconds(lambda items=sequence: tagger.tag(items), 100)
            for expected in (True, False):
                scorer = labeller.scorer(team, expected=expected)
                context = scorer.root(states[0])
                for place, operator in enumerate(operators):
                    context = scorer.extend(context, operator, states[place], states[place + 1])
                own = microseconds(lambda s=scorer, c=context, e=states[-1], t=tail: s.score(c, e, t), 2000)
                kind = "expected" if expected else "Viterbi"
                print(f"path {length}: {kind} {own:.2f}, CRFsuite {peer:.1f}")


if __name__ == "__main__":
    main()

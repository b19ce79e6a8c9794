"""Training on permutation-augmented traces: this package against CRFsuite, each in a process of its own.

Run ``python benchmarks/crf_training.py``. It prints one line per program: seconds of CPU time for reading and
for training, peak memory beyond that of an idle interpreter, penalised loss. Both see the same streams
of sequences, made anew in each process, and stop after the same number of iterations.
"""

import argparse
import itertools
import json
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Iterable, Iterator

import numpy as np

from explicable.labelling.augment import ground_symbol_features, permute, random_permutations

Sequence = tuple[list, list[str]]  # features and labels

GRID = 8
CELLS = tuple(f"c-{row}-{column}" for row in range(GRID) for column in range(GRID))


def base_traces(rng: np.random.Generator, num_traces: int) -> Iterator[tuple[tuple, list[str]]]:
    """Yield random walks of 24 to 35 steps on a grid; going back and standing by a wall look inexplicable."""
    for _ in range(num_traces):
        place, before, actions, labels = rng.integers(1, GRID - 1, 2), None, [], []
        for _ in range(rng.integers(24, 36)):
            steps = [
                place + d
                for d in ((0, 1), (1, 0), (0, -1), (-1, 0))
                if 0 <= min(place + d) <= max(place + d) < GRID
            ]
            after = steps[rng.integers(len(steps))]
            actions.append(("move", "r1", f"c-{place[0]}-{place[1]}", f"c-{after[0]}-{after[1]}"))
            odd = before is not None and tuple(after) == tuple(before)
            labels.append(str(bool(rng.random() < (0.2 if odd else 0.85))))
            place, before = after, place
        yield tuple(actions), labels


def sequences(num_traces: int, num_permutations: int, seed: int = 0) -> Iterator[Sequence]:
    """Yield features and labels: ground symbols of each step and of the step before."""
    rng = np.random.default_rng(seed)
    for actions, labels in base_traces(rng, num_traces):
        copies = (permute(actions, p) for p in random_permutations(rng, [CELLS], num_permutations))
        for copy in itertools.chain([actions], copies):
            yield ground_symbol_features(copy, window=1), labels


def run_explicable(data: Iterable[Sequence], iterations: int, c2: float) -> dict:
    """Train the model of this package."""
    from explicable.labelling.crf import ConditionalRandomField

    warnings.simplefilter("ignore")
    start = time.process_time()
    crf = ConditionalRandomField(c2=c2, max_iterations=iterations, tolerance=0.0)
    answers = []  # gathered while the features are read

    def features_of_data() -> Iterator[list]:
        for features, labels in data:
            answers.append(labels)
            yield features

    training = crf.prepare(features_of_data(), answers)
    read_s = time.process_time() - start
    optimum = training.minimise()
    return {
        "read_s": read_s,
        "train_s": time.process_time() - start - read_s,
        "loss": optimum.objective,
        "iterations": optimum.num_iterations,
        "weights": len(optimum.weights),
    }


def run_crfsuite(data: Iterable[Sequence], iterations: int, c2: float) -> dict:
    """Train CRFsuite's."""
    import pycrfsuite

    start = time.process_time()
    trainer = pycrfsuite.Trainer(algorithm="lbfgs", verbose=False)
    trainer.set_params(
        {"c1": 0.0, "c2": c2, "max_iterations": iterations, "epsilon": 0.0, "delta": 0.0, "num_memories": 10}
    )
    trainer.set_params({"feature.possible_states": True, "feature.possible_transitions": True})
    for features, labels in data:
        trainer.append(features, labels)
    read_s = time.process_time() - start
    with tempfile.NamedTemporaryFile() as model:
        trainer.train(model.name)
    last = trainer.logparser.last_iteration
    return {
        "read_s": read_s,
        "train_s": time.process_time() - start - read_s,
        "loss": last["loss"],
        "iterations": last["num"],
        "weights": trainer.logparser.last_iteration["active_features"],
    }


def main() -> None:
    """Run one program, or both."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--traces", type=int, default=34)
    parser.add_argument("--permutations", type=int, default=1000)
    parser.add_argument("--iterations", type=int, default=100)
    parser.add_argument("--c2", type=float, default=1.0)
    parser.add_argument("--program", choices=["explicable", "crfsuite"])
    arguments = parser.parse_args()
    if arguments.program is None:
        for program in ("explicable", "crfsuite"):
            subprocess.run([sys.executable, __file__, *sys.argv[1:], "--program", program], check=True)
        return
    idle_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    data = sequences(arguments.traces, arguments.permutations)
    run = run_explicable if arguments.program == "explicable" else run_crfsuite
    record = run(data, arguments.iterations, arguments.c2)
    peak_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    record["memory_mib"] = (peak_kib - idle_kib) / 1024
    print(json.dumps({"program": arguments.program} | record))


if __name__ == "__main__":
    main()

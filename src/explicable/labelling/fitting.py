"""From labelled traces to what a labeller consists of; for users, `explicable.labelling.Labeller.train`."""

import math
from collections.abc import Iterable, Mapping

import numpy as np

from explicable.errors import UsageError
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.doubt import with_doubt
from explicable.labelling.labeller_file import LabellerContent
from explicable.labelling.learning import CLASSES, Symbols, TrainingData
from explicable.labelling.population import fit_population
from explicable.labelling.traces import Trace


def fit_labeller(
    traces: Iterable[Trace],
    *,
    c1: float,
    c2: float,
    num_bootstrap: int,
    seed: int,
    annotator_weights: Mapping[str, float],
    symbols: Symbols,
    num_copies: int,
    doubt: float,
) -> LabellerContent:
    """Train the models of a labeller; parameters and errors as of `Labeller.train`."""
    if num_bootstrap < 0:
        raise UsageError(f"the number of bootstrap models must not be negative, as {num_bootstrap} is")
    if num_copies < 0 or (num_copies and symbols == "lifted"):
        raise UsageError("copies with other names are for ground symbols, and their number is at least 0")
    if not 0 <= doubt < math.inf:
        raise UsageError(f"doubt must be finite and at least 0, not {doubt}")
    data = TrainingData(symbols, num_copies, np.random.default_rng((seed, 1)))
    for trace in traces:
        data.add(trace)
    if data.num_labels == 0:
        raise UsageError("no robot's step has a label: there is nothing to learn from")
    sample_weight = [float(annotator_weights.get(name, 1.0)) for name in data.annotators]
    model = ConditionalRandomField(c1=c1, c2=c2, classes=CLASSES)
    weight_of_copies = np.repeat(sample_weight, 1 + num_copies)
    model.fit(data.sequences(), data.answers(), weight_of_copies, data.given())
    summary = {
        "c1": c1,
        "c2": c2,
        "num_bootstrap": num_bootstrap,
        "num_copies": num_copies,
        "doubt": 0.0 if symbols == "ground" else doubt,
        "seed": seed,
        "num_traces": len(data.labels),
        "num_labels": data.num_labels,
        "annotators": len(set(data.annotators)),
        "objective": model.objective_,
    }
    rng = np.random.default_rng(seed)
    bootstrap = fit_population(model, data, rng, num_bootstrap, sample_weight) if num_bootstrap else []
    models = [model, *bootstrap, *_model_of_tasks(model, data, sample_weight)]
    if symbols == "lifted":
        models = with_doubt(models, doubt)
    return LabellerContent(
        models[0],
        tuple(models[1 : 1 + num_bootstrap]),
        tuple(sorted(data.schemas)),
        summary,
        symbols,
        models[-1] if data.task_names else None,
    )


def _model_of_tasks(
    model: ConditionalRandomField, data: TrainingData, sample_weight: list[float]
) -> list[ConditionalRandomField]:
    """Train a model of which task a step serves, with the parameters of `model`, if annotators named any."""
    if not data.task_names:
        return []
    named = ConditionalRandomField(c1=model.c1, c2=model.c2, classes=(True, *data.task_names, False))
    answers = (row for row in data.task_labels for _ in range(1 + data.num_copies))
    weight_of_copies = np.repeat(sample_weight, 1 + data.num_copies)
    return [named.fit(data.sequences(), answers, weight_of_copies, data.given())]

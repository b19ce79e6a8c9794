"""From traces to models: features and labels of traces, and a bootstrap whose models stand for annotators."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from explicable.errors import PlanError, TraceError
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.features import TeamFeatures
from explicable.labelling.traces import Trace
from explicable.labelling.uncertainty import bootstrap_weights
from explicable.model.grounding import ground_team

if TYPE_CHECKING:
    from explicable.model.team import TeamProblem

CLASSES = (True, False)
"""Explicable and inexplicable; ties go to the first, and the second is the paper's empty label."""

_OFFSET = "annotator: "
_STEP = "step: "  # of these features, every robot's step has exactly one


class TrainingData:
    """Features and labels of traces; each problem is grounded once."""

    def __init__(self) -> None:
        self.features: list[list[tuple[str, ...]]] = []
        self.labels: list[list[bool | None]] = []
        self.annotators: list[str] = []
        self.schemas: set[str] = set()
        self.num_labels = 0
        self._teams: dict[int, tuple[TeamProblem, TeamFeatures]] = {}  # holds on to problems: ids stay unique

    def add(self, trace: Trace) -> None:
        """Take in a trace.

        Raises
        ------
        TraceError
            If it can't be executed in its problem; ``line`` is the number of the trace, from 1.
        """
        if id(trace.problem) not in self._teams:
            self._teams[id(trace.problem)] = (trace.problem, TeamFeatures(ground_team(trace.problem)))
        team = self._teams[id(trace.problem)][1]
        try:
            execution = team.task.execute(trace.actions)
        except PlanError as error:
            raise TraceError(error.message, line=len(self.labels) + 1) from error
        self.features.append(team.extract(execution.operators, execution.states))
        self.annotators.append(trace.annotator)
        labels: list[bool | None] = []
        for step, operator in zip(trace.steps, execution.operators, strict=True):
            is_human = team.tables.is_human(operator)
            labels.append(True if is_human else step.label)
            if not is_human:
                self.schemas.add(step.action[0])
                self.num_labels += step.label is not None
        self.labels.append(labels)


def fit_annotators(
    model: ConditionalRandomField,
    data: TrainingData,
    rng: np.random.Generator,
    num_draws: int,
    sample_weight: Sequence[float],
) -> list[ConditionalRandomField]:
    """Train models that each stand for one annotator, by a Bayesian bootstrap over annotators.

    Each annotator has an offset, in log odds, for every step; the penalty keeps it small where there is
    little to learn it from. A draw weighs annotators at random, trains, and takes on the offset of one of
    them, drawn by weight. So the draws differ as much as new annotators would. Of a single annotator, traces
    are weighed, and there is no offset.

    Parameters
    ----------
    model
        Gives the parameters and is not changed.
    data
        What to train on.
    rng
        Source of weights and of annotators.
    num_draws
        Number of models.
    sample_weight
        Weight of each trace; multiplied by that of the draw.
    """
    names = sorted(set(data.annotators))
    several = len(names) > 1
    group = (
        np.array([names.index(name) for name in data.annotators]) if several else np.arange(len(data.labels))
    )
    features = [
        [(*row, _OFFSET + name) if row and several else row for row in rows]
        for rows, name in zip(data.features, data.annotators, strict=True)
    ]
    training = model.prepare(features, data.labels)
    base = np.array(sample_weight)
    start = training.minimise(base).weights
    models = []
    for weights in bootstrap_weights(rng, int(group.max()) + 1, num_draws):
        drawn = ConditionalRandomField(**model.get_params())
        drawn.adopt(training, training.minimise(base * weights[group], start))
        stands_for = names[int(rng.choice(len(names), p=weights / weights.sum()))] if several else None
        models.append(_take_on_offset(drawn, stands_for))
    return models


def _take_on_offset(model: ConditionalRandomField, annotator: str | None) -> ConditionalRandomField:
    """Return the model with one annotator's offset in the weights of all steps, and the others' left out."""
    names, weights = model.feature_names_, model.state_weights_.copy()
    offset = f"{_OFFSET}{annotator}"
    if offset in names:
        steps = [number for number, name in enumerate(names) if name.startswith(_STEP)]
        weights[steps] += weights[names.index(offset)]
    kept = [number for number, name in enumerate(names) if not name.startswith(_OFFSET)]
    return ConditionalRandomField.from_weights(
        CLASSES, [names[number] for number in kept], weights[kept], model.transition_weights_
    )

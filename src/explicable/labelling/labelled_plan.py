"""What a labeller says of a plan."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.score import PlanScores
from explicable.labelling.uncertainty import fraction_interval, mix
from explicable.model.problem import GroundAtom


@dataclass(frozen=True)
class LabelledPlan:
    """What a labeller says of a plan.

    Attributes
    ----------
    actions
        The plan.
    is_robot
        Whether each step is a robot's; a human's is explicable by definition.
    probabilities
        Of each step: the probability that it is explicable.
    labels
        The most probable labels (Viterbi), True for explicable.
    task_labels
        The most probable labels where annotators named tasks: the task that a step serves, False for
        inexplicable, True for explicable without a task named. The same as `labels` where none did.
    features
        Of each step, by name; none for human steps. Those that no trace showed in training are named
        `explicable.labelling.templates.UNFAMILIAR`.
    unfamiliar
        Whether each step has such features: what people make of it is a guess.
        False for human steps, and where features are ground symbols.
    scores
        Explicability in all variants, the weights taken for granted.
    models
        The labeller's bootstrap, or the labeller's model alone: who a new annotator may turn out to be.
    """

    actions: tuple[GroundAtom, ...]
    is_robot: tuple[bool, ...]
    probabilities: tuple[float, ...]
    labels: tuple[bool, ...]
    task_labels: tuple[bool | str, ...]
    features: tuple[tuple[str, ...], ...]
    unfamiliar: tuple[bool, ...]
    scores: PlanScores
    models: tuple[ConditionalRandomField, ...] = field(repr=False, compare=False)

    @cached_property
    def distribution(self) -> NDArray[np.float64]:
        """Entry k: probability that a new annotator finds k of the robots' steps explicable.

        Uncertainty of the weights and differences between annotators are included. Worked out when first
        asked for: it takes all models of the bootstrap, and planning has no use for it.
        """
        return mix(
            [
                model.predict_counts(
                    [self.features], empty=False, clamp=[clamp_humans(self.is_robot)], counted=[self.is_robot]
                )[0]
                for model in self.models
            ]
        )

    def interval(
        self, level: float = 0.95, steps: Literal["robot", "paper"] = "robot"
    ) -> tuple[float, float]:
        """Return the central interval of ``F_robot`` or ``F_paper`` as a new annotator would give it.

        Raises
        ------
        UsageError
            If no step counts, or the level is not between 0 and 1.
        """
        if steps == "robot":
            return fraction_interval(self.distribution, level)
        num_human = len(self.actions) - sum(self.is_robot)
        return fraction_interval(np.concatenate([np.zeros(num_human), self.distribution]), level)


def clamp_humans(is_robot: Sequence[bool]) -> list[bool | None]:
    """Return the labels that are given: human steps are explicable by definition."""
    return [None if robot else True for robot in is_robot]

"""How well a labeller predicts traces that it was not trained on."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from explicable.errors import UsageError
from explicable.labelling.features import TeamFeatures
from explicable.labelling.labeller import Labeller
from explicable.labelling.quality import LabelQuality, label_quality
from explicable.labelling.score import score_labels
from explicable.labelling.traces import Trace, split_traces
from explicable.model.grounding import ground_team

LEVELS = (0.9, 0.95)


@dataclass(frozen=True, slots=True)
class Validation:
    """Predictions for held-out traces against the labels that were given.

    Attributes
    ----------
    num_traces
        Held-out traces with a labelled robot's step.
    steps
        Quality of the labels of single steps.
    mae_robot, mae_all_steps
        Mean absolute error of E[F] over traces: of the robots' steps that were labelled, and of all steps,
        the others being explicable by definition.
    covered
        For each of `LEVELS`: the share of traces whose ``F_robot`` lay in the interval predicted.
    """

    num_traces: int
    steps: LabelQuality
    mae_robot: float
    mae_all_steps: float
    covered: tuple[float, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return all figures by name, for records and files."""
        calibration = self.steps.calibration
        return {
            "num_traces": self.num_traces,
            "num_steps": self.steps.num_steps,
            "mae_robot": self.mae_robot,
            "mae_all_steps": self.mae_all_steps,
            **{
                f"covered_{100 * level:.0f}": share for level, share in zip(LEVELS, self.covered, strict=True)
            },
            "log_loss": self.steps.log_loss,
            "base_log_loss": self.steps.base_log_loss,
            "accuracy": self.steps.accuracy,
            "auc": self.steps.auc,
            "calibration_error": calibration.error,
            "calibration": {
                "predicted": calibration.predicted.tolist(),
                "observed": calibration.observed.tolist(),
                "num_steps": calibration.num_steps.tolist(),
            },
        }


def validate(labeller: Labeller, traces: Iterable[Trace]) -> Validation:
    """Compare what a labeller predicts with labelled traces that it has not seen.

    Raises
    ------
    UsageError
        If no robot's step has a label.
    """
    found = _Comparison()
    found.add(labeller, traces)
    return found.result()


def cross_validate(
    traces: Sequence[Trace],
    train: Callable[[list[Trace]], Labeller] = Labeller.train,
    *,
    num_folds: int = 5,
    by: Literal["problem", "annotator"] = "problem",
    tell: Callable[[int], None] = lambda _: None,
) -> Validation:
    """Predict each trace by a labeller that has seen none of its problem, or none of its annotator.

    Parameters
    ----------
    traces
        All traces.
    train
        Makes a labeller from traces.
    num_folds
        In so many parts are the problems, or annotators, divided, in the order of their appearance.
    by
        What is held out.
    tell
        Is called with the number of each fold, from 0, before the work on it begins.

    Raises
    ------
    UsageError
        If there are fewer problems (or annotators) than folds.

    Examples
    --------
    >>> cross_validate([], num_folds=2)
    Traceback (most recent call last):
    explicable.errors.UsageError: 2 folds by problem need as many: there are 0
    """
    groups = list(split_traces(traces, by).values())
    if not 2 <= num_folds <= len(groups):
        raise UsageError(f"{num_folds} folds by {by} need as many: there are {len(groups)}")
    found = _Comparison()
    for fold in range(num_folds):
        tell(fold)
        kept = [trace for n, group in enumerate(groups) if n % num_folds != fold for trace in group]
        found.add(train(kept), [trace for group in groups[fold::num_folds] for trace in group])
    return found.result()


class _Comparison:
    """Predictions and labels, gathered trace by trace."""

    def __init__(self) -> None:
        self.labels: list[bool | None] = []
        self.probabilities: list[float] = []
        self.errors: list[tuple[float, float]] = []
        self.covered: list[tuple[bool, ...]] = []

    def add(self, labeller: Labeller, traces: Iterable[Trace]) -> None:
        teams: dict[int, tuple[Trace, TeamFeatures]] = {}  # keeps the problem: its id stays its own
        for trace in traces:
            if id(trace.problem) not in teams:
                teams[id(trace.problem)] = trace, TeamFeatures(ground_team(trace.problem))
            plan = labeller.label(teams[id(trace.problem)][1], trace.actions)
            given = [
                step.is_explicable if robot else None
                for step, robot in zip(trace.steps, plan.is_robot, strict=True)
            ]
            self.labels += given
            self.probabilities += plan.probabilities
            asked = [
                (probability, label)
                for probability, label in zip(plan.probabilities, given, strict=True)
                if label is not None
            ]
            if not asked:
                continue
            missed = abs(sum(probability - label for probability, label in asked))
            self.errors.append((missed / len(asked), missed / len(given)))
            if len(asked) == sum(plan.is_robot):  # else F is not known
                f_robot = score_labels(given, plan.is_robot).f_robot or 0.0
                intervals = [plan.interval(level) for level in LEVELS]
                self.covered.append(tuple(low - 1e-9 <= f_robot <= high + 1e-9 for low, high in intervals))

    def result(self) -> Validation:
        steps = label_quality(self.labels, self.probabilities)
        robot, all_steps = np.mean(self.errors, axis=0).tolist()
        covered = np.mean(self.covered, axis=0).tolist() if self.covered else [float("nan")] * len(LEVELS)
        return Validation(len(self.errors), steps, robot, all_steps, tuple(covered))

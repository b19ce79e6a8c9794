"""Explicability of a labelled plan, in all the variants of method.md, section 2."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from explicable.errors import UsageError
from explicable.labelling.crf import ConditionalRandomField, Label
from explicable.labelling.sequences import FeatureSequence


@dataclass(frozen=True, slots=True)
class Explicability:
    """Explicability of the steps that count, from 0 to 1, most explicable.

    Attributes
    ----------
    num_steps
        How many steps count.
    by_labels
        Fraction labelled explicable (Eq. 1 of the paper). None if no step counts, as are the next two.
    expected
        Expected fraction under the labeller, ``E[F]``.
    variance
        Variance of that fraction under the labeller, its weights taken for granted.
    """

    num_steps: int
    by_labels: float | None
    expected: float | None
    variance: float | None


@dataclass(frozen=True, slots=True)
class PlanScores:
    """All scores of one plan, or of several together.

    ``paper`` counts all steps, human ones being explicable by definition; ``robot`` counts the robots' steps;
    ``asked`` those about which an annotator was asked.

    Examples
    --------
    >>> scores = score_labels([True, None, False], is_robot=[True, False, True])
    >>> scores.f_paper, scores.f_robot
    (0.6666666666666666, 0.5)
    """

    paper: Explicability
    robot: Explicability
    asked: Explicability

    @property
    def f_paper(self) -> float | None:
        """Fraction of explicable steps; human steps are explicable."""
        return self.paper.by_labels

    @property
    def f_robot(self) -> float | None:
        """Fraction of explicable steps among the robots' steps."""
        return self.robot.by_labels

    @property
    def f_asked(self) -> float | None:
        """Fraction of explicable steps among those asked about."""
        return self.asked.by_labels

    @property
    def f_expected(self) -> float | None:
        """Expected fraction over all steps; human steps are explicable."""
        return self.paper.expected

    @property
    def f_robot_expected(self) -> float | None:
        """Expected fraction over the robots' steps."""
        return self.robot.expected

    @property
    def f_asked_expected(self) -> float | None:
        """Expected fraction over the steps asked about."""
        return self.asked.expected

    def as_dict(self) -> dict[str, float | int | None]:
        """Return every score by its full name, for records and files."""
        record: dict[str, float | int | None] = {}
        for name, part in (("paper", self.paper), ("robot", self.robot), ("asked", self.asked)):
            expected = "f_expected" if name == "paper" else f"f_{name}_expected"
            record[f"f_{name}"] = part.by_labels
            record[expected] = part.expected
            record[f"{expected}_variance"] = part.variance
            record[f"num_{name}_steps"] = part.num_steps
        return record

    @classmethod
    def pooled(cls, scores: Iterable[Self]) -> Self:
        """Return the scores of several plans as of one long plan: ratios of sums."""
        rows = list(scores)
        return cls(*(_pool([getattr(row, name) for row in rows]) for name in ("paper", "robot", "asked")))

    @classmethod
    def macro(cls, scores: Iterable[Self]) -> Self:
        """Return the means of the scores over plans, each plan counting alike; plans without steps do not."""
        rows = list(scores)
        return cls(*(_average([getattr(row, name) for row in rows]) for name in ("paper", "robot", "asked")))


def score_plan(
    model: ConditionalRandomField,
    features: FeatureSequence,
    is_robot: Sequence[bool],
    *,
    empty: Label = False,
    explicable: Label = True,
    is_asked: Sequence[bool] | None = None,
) -> PlanScores:
    """Return the scores that a labeller gives to a plan; human steps are clamped to `explicable`.

    Parameters
    ----------
    model
        The labeller.
    features
        Features of each step.
    is_robot
        Whether each step is a robot's.
    empty
        The label of inexplicable steps.
    explicable
        The label that human steps get.
    is_asked
        Whether an annotator was asked about each step. Default: about none.

    Raises
    ------
    UsageError
        If features and flags differ in number.

    Examples
    --------
    >>> model = ConditionalRandomField.from_weights([False, True], ["odd"], [[1.0, 0.0]], [[0, 0], [0, 0]])
    >>> scores = score_plan(model, [["odd"], [], ["odd"]], is_robot=[True, True, False])
    >>> round(scores.f_paper, 3), round(scores.f_robot_expected, 3)
    (0.333, 0.384)
    """
    positions = list(features)
    robot = np.array(is_robot, dtype=np.bool_)
    asked = np.zeros(len(robot), dtype=np.bool_) if is_asked is None else np.array(is_asked, dtype=np.bool_)
    if not len(positions) == len(robot) == len(asked):
        raise UsageError("features, is_robot and is_asked need one entry for each step")
    clamp = [[None if is_robots else explicable for is_robots in robot]]
    (labels,) = model.predict([positions], clamp)
    explicable_steps = np.array([label != empty for label in labels], dtype=np.bool_)

    def count(counted: NDArray[np.bool_]) -> Explicability:
        (distribution,) = model.predict_counts([positions], empty, clamp, [counted.tolist()])
        return _explicability(explicable_steps[counted], distribution)

    return PlanScores(count(np.ones(len(robot), dtype=np.bool_)), count(robot), count(asked))


def score_labels(
    labels: Sequence[bool | None], is_robot: Sequence[bool], *, is_asked: Sequence[bool] | None = None
) -> PlanScores:
    """Return the scores of a plan that a person labelled; what is certain has no variance.

    Parameters
    ----------
    labels
        Whether each step is explicable; None where nobody was asked: such steps count as explicable in
        ``paper`` and, if a robot's, in ``robot``, as in the paper.
    is_robot
        Whether each step is a robot's.
    is_asked
        Whether an annotator was asked about each step. Default: where there is a label.

    Raises
    ------
    UsageError
        If labels and flags differ in number.
    """
    if is_asked is None:
        is_asked = [label is not None for label in labels]
    if not len(labels) == len(is_robot) == len(is_asked):
        raise UsageError("labels, is_robot and is_asked need one entry for each step")
    judged = np.array([label is None or bool(label) for label in labels], dtype=np.bool_)
    robot = np.array(is_robot, dtype=np.bool_)
    asked = np.array(is_asked, dtype=np.bool_)
    return PlanScores(
        _explicability(judged | ~robot), _explicability(judged[robot]), _explicability(judged[asked])
    )


def mean_and_variance(distribution: NDArray[np.float64]) -> tuple[float, float]:
    """Return mean and variance of a count with the given distribution (entry k: probability of k).

    Examples
    --------
    >>> mean_and_variance(np.array([0.25, 0.5, 0.25]))
    (1.0, 0.5)
    """
    counts = np.arange(len(distribution))
    mean = float(distribution @ counts)
    return mean, float(distribution @ (counts - mean) ** 2)


def _explicability(
    explicable: NDArray[np.bool_], distribution: NDArray[np.float64] | None = None
) -> Explicability:
    num_steps = len(explicable)
    if num_steps == 0:
        return Explicability(0, None, None, None)
    by_labels = float(explicable.mean())
    if distribution is None:
        return Explicability(num_steps, by_labels, by_labels, 0.0)
    mean, variance = mean_and_variance(distribution)
    return Explicability(num_steps, by_labels, min(mean / num_steps, 1.0), variance / num_steps**2)


def _pool(parts: list[Explicability]) -> Explicability:
    total = sum(part.num_steps for part in parts)
    return _combine(parts, total, [part.num_steps / total for part in parts if part.num_steps])


def _average(parts: list[Explicability]) -> Explicability:
    num_plans = sum(part.num_steps > 0 for part in parts)
    return _combine(
        parts, sum(part.num_steps for part in parts), [1 / num_plans] * num_plans if num_plans else []
    )


def _combine(parts: list[Explicability], num_steps: int, shares: list[float]) -> Explicability:
    """Weigh independent plans, those with steps, by their shares."""
    rows = [
        (part.by_labels, part.expected, part.variance)
        for part in parts
        if part.by_labels is not None and part.expected is not None and part.variance is not None
    ]
    if not rows:
        return Explicability(0, None, None, None)
    weights = np.array(shares)
    by_labels, expected, variance = np.array(rows).T
    return Explicability(
        num_steps, float(weights @ by_labels), float(weights @ expected), float(weights**2 @ variance)
    )

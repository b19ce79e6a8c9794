"""The labeller: learns from traces what people find explicable, and labels plans that nobody has seen yet."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from explicable import _core
from explicable.errors import LabellerError, UsageError
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.features import TeamFeatures
from explicable.labelling.labeller_file import LabellerContent, read_labeller, write_labeller
from explicable.labelling.learning import CLASSES, TrainingData, fit_annotators
from explicable.labelling.score import PlanScores, score_plan
from explicable.labelling.templates import explain_feature, feature_code
from explicable.labelling.traces import Trace
from explicable.labelling.uncertainty import fraction_interval, mix
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem, TeamTask, schema_kind

if TYPE_CHECKING:
    from typing import Self


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
    features
        Of each step, by name; none for human steps.
    scores
        Explicability in all variants, the weights taken for granted.
    models
        The labeller's bootstrap, or the labeller's model alone: who a new annotator may turn out to be.
    """

    actions: tuple[GroundAtom, ...]
    is_robot: tuple[bool, ...]
    probabilities: tuple[float, ...]
    labels: tuple[bool, ...]
    features: tuple[tuple[str, ...], ...]
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
                    [self.features], empty=False, clamp=[_clamp(self.is_robot)], counted=[self.is_robot]
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


class Labeller:
    r"""A trained labeller; see `train` and `load`.

    Parameters
    ----------
    model
        The conditional random field, its classes in the order of `CLASSES`.
    bootstrap
        Models that each stand for one annotator; how they differ says how sure the labeller is.
    schemas
        Names of the robots' action schemas that occurred in training.
    summary
        How it was trained.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import parse_map
    >>> from explicable.labelling.traces import LabelledStep
    >>> from explicable.model.grounding import ground_team
    >>> problem = encode(parse_map("#####\n#@.*#\n#####\n"))
    >>> plan = [
    ...     ("command", "person", "c-1-3"),
    ...     ("move", "r1", "c-1-1", "c-1-2"),
    ...     ("move", "r1", "c-1-2", "c-1-1"),
    ... ]
    >>> steps = tuple(LabelledStep(a[1], a, answer) for a, answer in zip(plan, (None, True, False)))
    >>> labeller = Labeller.train([Trace(problem, steps, "anna", "person")], c2=0.01, num_bootstrap=0)
    >>> labeller.label(ground_team(problem), plan).labels
    (True, True, False)
    """

    def __init__(
        self,
        model: ConditionalRandomField,
        bootstrap: Sequence[ConditionalRandomField] = (),
        schemas: Iterable[str] = (),
        summary: Mapping[str, Any] | None = None,
    ) -> None:
        self.model = model
        self.bootstrap = tuple(bootstrap)
        self.schemas = tuple(sorted(set(schemas)))
        self.summary = dict(summary or {})

    @classmethod
    def train(
        cls,
        traces: Iterable[Trace],
        *,
        c1: float = 0.0,
        c2: float = 1.0,
        num_bootstrap: int = 50,
        seed: int = 0,
        annotator_weights: Mapping[str, float] | None = None,
    ) -> "Self":
        """Train on labelled traces.

        Human steps are explicable by definition, whatever label they carry; steps that nobody was asked about
        are unobserved. If all labels are alike, so will be the most probable labels of every plan.

        Parameters
        ----------
        traces
            Of any problems, domains and annotators.
        c1, c2
            Weights of the L1 and L2 penalty.
        num_bootstrap
            Number of models of the Bayesian bootstrap; 0: intervals take the weights for granted.
        seed
            Of the bootstrap.
        annotator_weights
            Weight of each annotator's traces; 1 where missing.

        Raises
        ------
        UsageError
            If no robot's step has a label, or a parameter is out of range.
        TraceError
            If a trace can't be executed in its problem; ``line`` is the number of the trace, from 1.
        """
        if num_bootstrap < 0:
            raise UsageError(f"the number of bootstrap models must not be negative, as {num_bootstrap} is")
        data = TrainingData()
        for trace in traces:
            data.add(trace)
        if data.num_labels == 0:
            raise UsageError("no robot's step has a label: there is nothing to learn from")
        sample_weight = [float((annotator_weights or {}).get(name, 1.0)) for name in data.annotators]
        model = ConditionalRandomField(c1=c1, c2=c2, classes=CLASSES)
        model.fit(data.features, data.labels, sample_weight)
        rng = np.random.default_rng(seed)
        bootstrap = fit_annotators(model, data, rng, num_bootstrap, sample_weight) if num_bootstrap else []
        summary = {
            "c1": c1,
            "c2": c2,
            "num_bootstrap": num_bootstrap,
            "seed": seed,
            "num_traces": len(data.labels),
            "num_labels": data.num_labels,
            "annotators": len(set(data.annotators)),
            "objective": model.objective_,
        }
        return cls(model, bootstrap, data.schemas, summary)

    @staticmethod
    def load(path: str | Path) -> "Labeller":
        """Read a labeller file.

        Raises
        ------
        LabellerError
            If it is damaged, of another version, or no labeller at all.
        """
        content = read_labeller(path)
        return Labeller(content.model, content.bootstrap, content.schemas, content.summary)

    def save(self, path: str | Path) -> None:
        """Write a labeller file, whole or not at all; `load` restores it exactly."""
        write_labeller(path, LabellerContent(self.model, self.bootstrap, self.schemas, self.summary))

    def label(self, team: TeamTask | TeamFeatures, actions: Sequence[GroundAtom]) -> LabelledPlan:
        """Label a plan of a team task.

        Parameters
        ----------
        team
            The task; handing in its `TeamFeatures` saves making them again.
        actions
            A plan from the initial state; it need not reach the goal.

        Raises
        ------
        PlanError
            If a step is not applicable.
        LabellerError
            If the labeller knows none of the task's action schemas.
        """
        features = self._features(team)
        execution = features.task.execute(actions)
        rows = features.extract(execution.operators, execution.states)
        is_robot = tuple(not features.tables.is_human(operator) for operator in execution.operators)
        clamp = [_clamp(is_robot)]
        (labels,) = self.model.predict([rows], clamp)
        (marginals,) = self.model.predict_marginals([rows], clamp)
        return LabelledPlan(
            actions=tuple(actions),
            is_robot=is_robot,
            probabilities=tuple(marginals[:, 0].tolist()),
            labels=tuple(bool(label) for label in labels),
            features=tuple(rows),
            scores=score_plan(self.model, rows, is_robot, is_asked=is_robot),
            models=self.bootstrap or (self.model,),
        )

    def scorer(
        self, team: TeamTask | TeamFeatures, *, expected: bool = True, history: Sequence[GroundAtom] = ()
    ) -> _core.Scorer:
        """Compile the labeller for a search over a team task.

        Parameters
        ----------
        team
            The task, or its `TeamFeatures`.
        expected
            Whether to count inexplicable steps by their probability; otherwise by the most probable labels.
        history
            Steps already done, from the task's initial state: every path that is scored begins with them.

        Raises
        ------
        PlanError
            If a step of the history is not applicable.
        LabellerError
            If the labeller knows none of the task's action schemas.
        """
        features = self._features(team)
        schemas = {name: number for number, name in enumerate(features.schemas)}
        weights = []
        for feature, weight in self._evidence.items():
            code = feature_code(feature, schemas, features.tables.max_arity)
            if code is not None:
                weights.append((*code, -weight))
        transitions = self.model.transition_weights_
        scorer = _core.Scorer(
            features.task.core, features.tables, weights, transitions.tolist(), expected=expected
        )
        if not history:
            return scorer
        execution = features.task.execute(history)
        context = scorer.root(execution.states[0])
        for operator, (before, after) in zip(execution.operators, pairwise(execution.states), strict=True):
            context = scorer.extend(context, operator, before, after)
        return scorer.starting_at(context)

    def explain(self, plan: LabelledPlan, num_features: int = 5) -> list[list[tuple[str, float]]]:
        """Tell what moved the label of each step most.

        Parameters
        ----------
        plan
            A plan that this labeller labelled.
        num_features
            At most so many a step.

        Returns
        -------
        list of lists of (text, float)
            For each step, the strongest first: what speaks for (positive) or against (negative) its being
            explicable, in log odds. Empty for human steps. Neighbouring labels speak too, but are left out.
        """
        explanations = []
        for names in plan.features:
            spoken = [(explain_feature(name), self._evidence.get(name, 0.0)) for name in names]
            spoken.sort(key=lambda pair: -abs(pair[1]))
            explanations.append([pair for pair in spoken if pair[1] != 0.0][:num_features])
        return explanations

    def unknown_schemas(self, problem: TeamProblem) -> tuple[str, ...]:
        """List the robots' action schemas that never occurred in training: their labels are guesses."""
        names = _robot_schemas(problem)
        return tuple(name for name in names if name not in self.schemas)

    def check_domain(self, problem: TeamProblem) -> None:
        """Refuse a problem of which this labeller knows none of the robots' action schemas.

        Raises
        ------
        LabellerError
            If it was trained on another domain.
        """
        names = _robot_schemas(problem)
        if names and len(self.unknown_schemas(problem)) == len(names):
            raise LabellerError(
                "this labeller was trained on another domain: "
                f"it knows {', '.join(self.schemas) or 'nothing'}, but robots here can {', '.join(names)}"
            )

    def _features(self, team: TeamTask | TeamFeatures) -> TeamFeatures:
        features = team if isinstance(team, TeamFeatures) else TeamFeatures(team)
        self.check_domain(features.team.problem)
        return features

    @cached_property
    def _evidence(self) -> dict[str, float]:
        """How much each feature speaks for explicable rather than inexplicable."""
        difference = self.model.state_weights_[:, 0] - self.model.state_weights_[:, 1]
        return dict(zip(self.model.feature_names_, difference.tolist(), strict=True))


def _robot_schemas(problem: TeamProblem) -> list[str]:
    domain = problem.composite.domain
    return [action.name for action in domain.actions if schema_kind(domain, action) == "robot"]


def _clamp(is_robot: Sequence[bool]) -> list[bool | None]:
    """Return the labels that are given: human steps are explicable by definition."""
    return [None if robot else True for robot in is_robot]

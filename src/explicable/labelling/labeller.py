"""The labeller: learns from traces what people find explicable, and labels plans that nobody has seen yet."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from explicable import _core
from explicable.errors import LabellerError, UsageError
from explicable.labelling.choices import ChoiceModel
from explicable.labelling.compiling import compile_scorer, evidence
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.doubt import DEFAULT_DOUBT, mark_unfamiliar
from explicable.labelling.features import TeamFeatures
from explicable.labelling.fitting import fit_labeller
from explicable.labelling.labelled_plan import LabelledPlan, clamp_humans
from explicable.labelling.labeller_file import LabellerContent, read_labeller, write_labeller
from explicable.labelling.learning import Rows, Symbols, step_features
from explicable.labelling.score import score_plan
from explicable.labelling.situations import HUMAN_FEATURES
from explicable.labelling.templates import UNFAMILIAR, explain_feature
from explicable.labelling.traces import Trace
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem, TeamTask, schema_kind

if TYPE_CHECKING:
    from typing import Self


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
    symbols
        Which features the models see: lifted ones, or the ground symbols of a step.
    task_model
        Says which task a step serves, if annotators named tasks.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.map_file import parse_map
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
        *,
        symbols: Symbols = "lifted",
        task_model: ConditionalRandomField | None = None,
    ) -> None:
        self.model = model
        self.bootstrap = tuple(bootstrap)
        self.schemas = tuple(sorted(set(schemas)))
        self.summary = dict(summary or {})
        self.symbols: Symbols = symbols
        self.task_model = task_model

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
        symbols: Symbols = "lifted",
        num_copies: int = 0,
        doubt: float = DEFAULT_DOUBT,
    ) -> "Self":
        """Train on labelled traces.

        Human steps are explicable by definition, whatever label they carry; steps that nobody was asked about
        are unobserved. If all labels are alike, so will be the most probable labels of every plan.

        A step whose label names a task is explicable: all scores, intervals and searches take the names for
        True. A second model, with one label for each name, tells which task a step serves.

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
        symbols
            ``ground``: the paper's features, the names that occur in a step, instead of lifted ones. What is
            learned so holds for objects of the same names only.
        num_copies
            With ground symbols: that many copies of each trace, its objects renamed at random, are trained
            on as well (the paper: 1000).
        doubt
            Log odds by which each lifted feature that no trace showed speaks against a step, so that a
            planner doesn't take what nobody has judged for explicable; 0: it says nothing. Of no effect with
            ground symbols, of which every new problem shows unknown ones.

        Raises
        ------
        UsageError
            If no robot's step has a label, or a parameter is out of range.
        TraceError
            If a trace can't be executed in its problem; ``line`` is the number of the trace, from 1.
        """
        return cls._of(
            fit_labeller(
                traces,
                c1=c1,
                c2=c2,
                num_bootstrap=num_bootstrap,
                seed=seed,
                annotator_weights=annotator_weights or {},
                symbols=symbols,
                num_copies=num_copies,
                doubt=doubt,
            )
        )

    @classmethod
    def load(cls, path: str | Path) -> "Self":
        """Read a labeller file.

        Raises
        ------
        LabellerError
            If it is damaged, of another version, or no labeller at all.
        """
        return cls._of(read_labeller(path))

    @classmethod
    def _of(cls, content: LabellerContent) -> "Self":
        return cls(
            content.model,
            content.bootstrap,
            content.schemas,
            content.summary,
            symbols=content.symbols,
            task_model=content.task_model,
        )

    def save(self, path: str | Path) -> None:
        """Write a labeller file, whole or not at all; `load` restores it exactly."""
        content = LabellerContent(
            self.model, self.bootstrap, self.schemas, self.summary, self.symbols, self.task_model
        )
        write_labeller(path, content)

    def label(
        self,
        team: TeamTask | TeamFeatures,
        actions: Sequence[GroundAtom],
        *,
        knowing: Sequence[TeamFeatures] | None = None,
    ) -> LabelledPlan:
        """Label a plan of a team task.

        Parameters
        ----------
        team
            The task; handing in its `TeamFeatures` saves making them again.
        actions
            A plan from the initial state; it need not reach the goal.
        knowing
            For each step, the same task with the mental model that the person has by then, if they are told
            something on the way.

        Raises
        ------
        PlanError
            If a step is not applicable.
        LabellerError
            If the labeller knows none of the task's action schemas or, trained on ground symbols, none of
            its objects.
        """
        features = self.features(team)
        execution = features.task.execute(actions)
        rows = self.familiar_features(step_features(features, execution, self.symbols, knowing))
        is_robot = tuple(not features.tables.is_human(operator) for operator in execution.operators)
        clamp = [clamp_humans(is_robot)]
        (labels,) = self.model.predict([rows], clamp)
        (marginals,) = self.model.predict_marginals([rows], clamp)
        (task_labels,) = [labels] if self.task_model is None else self.task_model.predict([rows], clamp)
        return LabelledPlan(
            actions=tuple(actions),
            is_robot=is_robot,
            probabilities=tuple(marginals[:, 0].tolist()),
            labels=tuple(bool(label) for label in labels),
            task_labels=tuple(task_labels),
            features=tuple(rows),
            unfamiliar=tuple(UNFAMILIAR in row for row in rows),
            scores=score_plan(self.model, rows, is_robot, is_asked=is_robot),
            models=self.bootstrap or (self.model,),
        )

    def scorer(
        self,
        team: TeamTask | TeamFeatures,
        *,
        expected: bool = True,
        history: Sequence[GroundAtom] = (),
        choice_model: ChoiceModel | None = None,
        charge: float = 0.0,
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
        choice_model
            What people choose (`explicable.labelling.situations`).
        charge
            With it, what a path is charged, in the unit of cost, for each nat of surprise (-log p) at what it
            makes the person do, waiting included. The history is not charged for.

        Raises
        ------
        UsageError
            If the charge is negative, infinite or not a number.
        PlanError
            If a step of the history is not applicable.
        LabellerError
            If the labeller knows none of the task's action schemas or, trained on ground symbols, none of
            its objects.
        """
        features = self.features(team)
        scorer = compile_scorer(self.model, features, symbols=self.symbols, expected=expected)
        if not (math.isfinite(charge) and charge >= 0):
            raise UsageError(f"the charge must be finite and at least 0, not {charge}")
        if choice_model is not None and charge > 0:
            found = dict(zip(choice_model.feature_names, choice_model.weights.tolist(), strict=True))
            scorer = scorer.charging(features.choices, [found.get(f, 0.0) for f in HUMAN_FEATURES], charge)
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
            spoken = [
                (explain_feature(name), number * self._evidence.get(name, 0.0))
                for name, number in Counter(names).items()
            ]
            spoken.sort(key=lambda pair: -abs(pair[1]))
            explanations.append([pair for pair in spoken if pair[1] != 0.0][:num_features])
        return explanations

    def familiar_features(self, rows: Rows) -> Rows:
        """Return the features of steps as the models know them: what no trace showed is called so."""
        return rows if self.symbols == "ground" else mark_unfamiliar(rows, self._familiar)

    def unknown_schemas(self, problem: TeamProblem) -> tuple[str, ...]:
        """List the robots' action schemas that never occurred in training: their labels are guesses."""
        names = _robot_schemas(problem)
        return tuple(name for name in names if name not in self.schemas)

    def check_domain(self, problem: TeamProblem) -> None:
        """Refuse a problem of which this labeller knows no robot's action, or no name if it needs names.

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
        objects = {**problem.composite.domain.constants, **problem.composite.objects}
        if self.symbols == "ground" and self._names.isdisjoint(objects):
            raise LabellerError(
                "this labeller was trained on names, and knows none of the objects here: "
                "train it on lifted features instead"
            )

    def features(self, team: TeamTask | TeamFeatures) -> TeamFeatures:
        """Return what the labeller sees of a task: to be made once for all that is asked about it.

        Raises
        ------
        LabellerError
            If it was trained on another domain.
        """
        features = team if isinstance(team, TeamFeatures) else TeamFeatures(team)
        self.check_domain(features.team.problem)
        return features

    @cached_property
    def _names(self) -> set[str]:
        """The names of objects that the model knows, of ground symbols such as ``2=kitchen``."""
        return {name.partition("=")[2] for name in self.model.feature_names_ if "=" in name}

    @cached_property
    def _familiar(self) -> frozenset[str]:
        """The features that occurred in training."""
        return frozenset(self.model.feature_names_)

    @cached_property
    def _evidence(self) -> dict[str, float]:
        return evidence(self.model)


def _robot_schemas(problem: TeamProblem) -> list[str]:
    domain = problem.composite.domain
    return [action.name for action in domain.actions if schema_kind(domain, action) == "robot"]

"""How good predicted labels are: on participants' own games, and on plans that were made to please."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np

from explicable.errors import UsageError
from explicable.evaluation.trials.training import (
    JUDGING,
    PLAYING,
    TRAINING,
    draw_participants,
    find_family,
    held_out,
    training_traces,
)
from explicable.execution import judge, prepare, simulate
from explicable.labelling import Labeller, Trace
from explicable.labelling.annotators import krippendorff_alpha
from explicable.labelling.augment import augment, ground_symbol_features
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.learning import CLASSES
from explicable.model.grounding import ground_team
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamTask
from explicable.planning import plan_classically, plan_explicably

Row = dict[str, Any]
Seed = tuple[int, int]

PROOF_S = 60.0


@dataclass(frozen=True, slots=True)
class Settings:
    """What a trial depends on.

    Parameters
    ----------
    semantics, family, judges, num_traces, noise, num_maps
        As in `explicable.evaluation.trials.plans.Settings`.
    features
        ``lifted``, or ``symbols``: the paper's ground symbols.
    num_permutations
        Of symbols, for each problem; only with ``symbols``.
    num_bootstrap
        Models that stand for annotators; for intervals, only with ``lifted``.
    num_judges
        Participants who judge every plan; of the first of them the labels are predicted.
    """

    semantics: Literal["persistent", "exclusive"] = "exclusive"
    family: str = "myopic"
    judges: str = ""
    num_traces: int = 34
    noise: float = -1.0
    num_maps: int = 0
    features: str = "lifted"
    num_permutations: int = 1000
    num_bootstrap: int = 0
    num_judges: int = 3

    def __post_init__(self) -> None:
        if self.features not in {"lifted", "symbols"}:
            raise UsageError(f"features are lifted or symbols, not {self.features!r}")
        find_family(self.family)


class Predictor(Protocol):
    """Predicts the labels of a plan's robot steps."""

    def predict(self, team: TeamTask, actions: Sequence[GroundAtom]) -> Row:
        """Return ``probabilities`` of the robot steps, and what else there is to say."""


class LiftedPredictor:
    """The labeller of this package."""

    def __init__(self, traces: Sequence[Trace], num_bootstrap: int) -> None:
        self.labeller = Labeller.train(traces, num_bootstrap=num_bootstrap)

    def predict(self, team: TeamTask, actions: Sequence[GroundAtom]) -> Row:
        """See `Predictor`."""
        found = self.labeller.label(team, actions)
        robots = [p for p, is_robot in zip(found.probabilities, found.is_robot, strict=True) if is_robot]
        row: Row = {"probabilities": robots, "viterbi": found.scores.f_robot}
        if self.labeller.bootstrap:
            row["interval"] = list(found.interval(0.95))
        return row


class SymbolPredictor:
    """The paper's: ground symbols of each step, and permuted copies of every trace."""

    def __init__(self, traces: Sequence[Trace], num_permutations: int, rng: np.random.Generator) -> None:
        labelled = [(trace.problem.composite, trace.actions, _with_human_steps(trace)) for trace in traces]
        features, labels = [], []
        for actions, answers in augment(rng, labelled, num_permutations):
            features.append(ground_symbol_features(actions))
            labels.append(answers)
        self.model = ConditionalRandomField(classes=CLASSES).fit(features, labels)

    def predict(self, team: TeamTask, actions: Sequence[GroundAtom]) -> Row:
        """See `Predictor`."""
        is_robot = [team.problem.agent_of(action).kind == "robot" for action in actions]
        rows, clamp = [ground_symbol_features(actions)], [[None if robot else True for robot in is_robot]]
        (marginals,) = self.model.predict_marginals(rows, clamp)
        (labels,) = self.model.predict(rows, clamp)
        robots = [
            (float(p), bool(label))
            for p, label, robot in zip(marginals[:, 0], labels, is_robot, strict=True)
            if robot
        ]
        return {
            "probabilities": [p for p, _ in robots],
            "viterbi": sum(label for _, label in robots) / len(robots),
        }


def measure(settings: Settings, seed: Seed) -> list[Row]:
    """Train, and predict what participants say of held-out plans: one row a plan."""
    traces = training_traces(seed, settings.family, settings.semantics, settings.num_traces, settings.noise)
    predictor: Predictor = (
        LiftedPredictor(traces, settings.num_bootstrap)
        if settings.features == "lifted"
        else SymbolPredictor(traces, settings.num_permutations, np.random.default_rng((*seed, TRAINING, 1)))
    )
    planner = Labeller.train(traces, num_bootstrap=0)
    judges = draw_participants(seed, settings.judges or settings.family, settings.num_judges)
    rows = []
    for held in held_out(seed, settings.semantics, settings.num_maps):
        team, setting = ground_team(held.problem), prepare(held.problem)
        game = simulate(setting, judges[0], np.random.default_rng((*seed, PLAYING, held.number)))
        plans = {"participants": game.trace.actions}
        for name, found in (
            ("ff", plan_classically(team, algorithm="ff")),
            ("explicable", plan_explicably(team, planner, improve_s=PROOF_S)),
        ):
            if found.plan is not None:
                plans[name] = found.plan.actions
        for name, actions in plans.items():
            answers = []
            for number, who in enumerate(judges):
                rng = np.random.default_rng((*seed, JUDGING, held.number, number))
                labels = [step.label for step in judge(setting, who, actions, rng)]
                answers.append([label for label in labels if label is not None])
            row = predictor.predict(team, actions)
            row["probabilities"] = [round(p, 4) for p in row["probabilities"]]
            ratings = [
                {who.name: bool(said[step]) for who, said in zip(judges, answers, strict=True)}
                for step in range(len(answers[0]))
            ]
            agreement = krippendorff_alpha(ratings) if len(judges) > 1 else None
            rows.append(
                {"map": held.name, "plan": name, "outcome": "measured", "labels": answers[0]}
                | {"agreement": agreement}
                | row
            )
    return rows


def _with_human_steps(trace: Trace) -> list[bool | None]:
    """Return the labels of all steps, human steps explicable by definition."""
    kind_of = {step.agent: trace.problem.agent_of(step.action).kind for step in trace.steps}
    return [True if kind_of[step.agent] == "human" else step.label for step in trace.steps]

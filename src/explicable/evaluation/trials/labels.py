"""How good predicted labels are: on participants' own games, and on plans that were made to please."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from explicable.evaluation.best_plan import plan_best
from explicable.evaluation.records import Row, Seed
from explicable.evaluation.trials.training import (
    JUDGING,
    PLAYING,
    draw_participants,
    find_family,
    held_out,
    train,
    training_traces,
)
from explicable.execution import StudyWay, judge, prepare, simulate
from explicable.labelling import Labeller
from explicable.labelling.annotators import krippendorff_alpha
from explicable.labelling.doubt import DEFAULT_DOUBT
from explicable.model.grounding import ground_team
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamTask
from explicable.planning import plan_classically


@dataclass(frozen=True, slots=True)
class Settings:
    """What a trial depends on.

    Parameters
    ----------
    semantics, family, judges, num_traces, way, noise, doubt, num_maps
        As in `explicable.evaluation.trials.plans.Settings`.
    symbols, num_copies
        Features: ``lifted``, or the paper's ``ground`` ones; copies of each trace with other names.
    num_bootstrap
        Models that stand for annotators, for intervals.
    num_judges
        Participants who judge every plan; of the first of them the labels are predicted.
    """

    semantics: Literal["persistent", "exclusive"] = "exclusive"
    family: str = "myopic"
    judges: str = ""
    num_traces: int = 34
    way: StudyWay = "mixed"
    noise: float = -1.0
    doubt: float = DEFAULT_DOUBT
    num_maps: int = 0
    symbols: Literal["lifted", "ground"] = "lifted"
    num_copies: int = 0
    num_bootstrap: int = 0
    num_judges: int = 3

    def __post_init__(self) -> None:
        find_family(self.family)


def measure(settings: Settings, seed: Seed) -> list[Row]:
    """Train, and predict what participants say of held-out plans: one row a plan."""
    traces = training_traces(
        seed, settings.family, settings.semantics, settings.num_traces, settings.noise, settings.way
    )
    labeller = Labeller.train(
        traces,
        num_bootstrap=settings.num_bootstrap,
        symbols=settings.symbols,
        num_copies=settings.num_copies,
        doubt=settings.doubt,
    )
    planner = train(traces, doubt=settings.doubt)
    judges = draw_participants(seed, settings.judges or settings.family, settings.num_judges)
    rows = []
    for held in held_out(seed, settings.semantics, settings.num_maps):
        team, setting = ground_team(held.problem), prepare(held.problem)
        game = simulate(setting, judges[0], np.random.default_rng((*seed, PLAYING, held.number)))
        plans = {"participants": game.trace.actions}
        for name, found in (
            ("ff", plan_classically(team, algorithm="ff")),
            ("explicable", plan_best(team, planner)),
        ):
            if found.plan is not None:
                plans[name] = found.plan.actions
        for name, actions in plans.items():
            answers = []
            for number, who in enumerate(judges):
                rng = np.random.default_rng((*seed, JUDGING, held.number, number))
                labels = [step.is_explicable for step in judge(setting, who, actions, rng)]
                answers.append([label for label in labels if label is not None])
            ratings = [
                {who.name: bool(said[step]) for who, said in zip(judges, answers, strict=True)}
                for step in range(len(answers[0]))
            ]
            agreement = krippendorff_alpha(ratings) if len(judges) > 1 else None
            rows.append(
                {"map": held.name, "plan": name, "outcome": "measured", "labels": answers[0]}
                | {"agreement": agreement}
                | _predict(labeller, team, actions)
            )
    return rows


def _predict(labeller: Labeller, team: TeamTask, actions: Sequence[GroundAtom]) -> Row:
    """Predict the labels of a plan's robot steps, and F_robot with its interval where there is one."""
    found = labeller.label(team, actions)
    robots = [p for p, is_robot in zip(found.probabilities, found.is_robot, strict=True) if is_robot]
    row: Row = {"probabilities": [round(p, 4) for p in robots], "viterbi": found.scores.f_robot}
    return row | {"interval": list(found.interval(0.95))} if labeller.bootstrap else row

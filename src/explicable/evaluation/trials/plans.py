"""Plans of several planners for the same maps, judged by the labeller, and by participants it has not met."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from explicable.errors import UsageError
from explicable.evaluation.best_plan import PROOF_EVALUATIONS, plan_best
from explicable.evaluation.ceiling import plan_for_judges
from explicable.evaluation.records import Row, Seed
from explicable.evaluation.trials.training import (
    JUDGING,
    PLAYING,
    HeldOutProblem,
    draw_participants,
    find_family,
    held_out,
    label_plans,
    read_study,
    train,
    training_problems,
    training_traces,
)
from explicable.execution import Participant, Setting, StudyWay, judge, prepare, simulate
from explicable.labelling import Labeller, Trace
from explicable.labelling.doubt import DEFAULT_DOUBT
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamTask
from explicable.planning import (
    HumanModel,
    TeamPlan,
    plan_as_in_paper,
    plan_classically,
    plan_explicably,
    plan_within_budget,
)
from explicable.planning.team_plan import DEFAULT_ALPHA


@dataclass(frozen=True, slots=True)
class Settings:
    """What a trial depends on.

    Parameters
    ----------
    semantics
        Of commands: ``persistent`` (the paper's PDDL) or ``exclusive``.
    family
        Of the participants whose traces the labeller learns from.
    judges
        Family of those who judge the plans; empty: the same.
    traces
        A file of a study's traces to learn from, in the place of simulated participants'; those of problems
        that are planned for stand for participants' own plans.
    num_traces
        To learn from.
    way
        In which these games are played: ``commanded``, or ``mixed`` with games in which the robot goes ahead
        unasked, as it does in many plans.
    num_own_plans
        Plans of planners, for the training maps, that participants have labelled too.
    noise
        Share of wrong labels in them; negative: as the family has it.
    symbols, num_copies
        Features: ``lifted``, or the paper's ``ground`` ones; copies of each trace with other names.
    doubt
        Of what no trace showed, in log odds a feature; lifted features only.
    num_maps
        Generated maps to plan for; 0: the package's four test maps.
    plans
        Which planners, see `PLANNERS`; ``participants`` stands for a simulated participant's game,
        ``ceiling`` for the plan that is best to the judges, were their minds known.
    alpha
        Price of an inexplicable step, in the unit of cost.
    num_judges
        Participants who judge every plan.
    keep_steps
        Whether the records of the first repeat hold maps and plans, for pictures.
    """

    semantics: Literal["persistent", "exclusive"] = "persistent"
    family: str = "myopic"
    judges: str = ""
    traces: str = ""
    num_traces: int = 34
    way: StudyWay = "mixed"
    num_own_plans: int = 0
    noise: float = -1.0
    symbols: Literal["lifted", "ground"] = "lifted"
    num_copies: int = 0
    doubt: float = DEFAULT_DOUBT
    num_maps: int = 0
    plans: tuple[str, ...] = ("ff", "shortest", "paper", "explicable", "participants")
    alpha: float = DEFAULT_ALPHA
    num_judges: int = 3
    keep_steps: bool = False

    def __post_init__(self) -> None:
        unknown = set(self.plans) - {*PLANNERS, "participants", "ceiling"}
        if unknown:
            raise UsageError(f"unknown plans {', '.join(sorted(unknown))}; known are {', '.join(PLANNERS)}")
        find_family(self.family)
        if self.traces and (self.noise >= 0 or self.num_own_plans):
            raise UsageError("noise and own plans are for simulated participants, not for a file of traces")


@dataclass(frozen=True, slots=True)
class Knowledge:
    """What the planners have learnt from traces."""

    labeller: Labeller
    human: HumanModel
    alpha: float


EXTRA = 0.05
"""How much dearer than the cheapest plan those with a budget may be: the paper's effect allows no more."""

_PLAYERS = 2**20
"""Added to a trial's seed: who plays is drawn by a seed that no trial has, and is none of the judges."""

Planner = Callable[[TeamTask, Knowledge], TeamPlan]

PLANNERS: dict[str, Planner] = {
    "ff": lambda team, _: plan_classically(team, algorithm="ff"),
    "shortest": lambda team, _: plan_classically(team, algorithm="astar"),
    "paper": lambda team, known: plan_as_in_paper(team, known.labeller),
    "greedy": lambda team, known: plan_explicably(team, known.labeller, alpha=known.alpha, improve_s=0),
    "greedy-viterbi": lambda team, known: plan_explicably(
        team, known.labeller, alpha=known.alpha, improve_s=0, expected=False
    ),
    "greedy-context": lambda team, known: plan_explicably(
        team, known.labeller, alpha=known.alpha, improve_s=0, closing="context"
    ),
    "explicable": lambda team, known: plan_best(team, known.labeller, alpha=known.alpha),
    "budget": lambda team, known: plan_within_budget(
        team,
        known.labeller,
        max_cost_increase=EXTRA,
        search_s=math.inf,
        max_evaluations=PROOF_EVALUATIONS,
    ),
    "charged": lambda team, known: plan_best(
        team, known.labeller, alpha=known.alpha, human_model=known.human, human_step_weight=1.0
    ),
}
"""Each planner by the name that it has in records."""


def measure(settings: Settings, seed: Seed) -> list[Row]:
    """Train, plan for each map with each planner, and have the plans judged: one row a plan."""
    problems = list(held_out(seed, settings.semantics, settings.num_maps))
    if settings.traces:
        traces, games = read_study(settings.traces, problems)
    else:
        traces, games = _simulated_traces(settings, seed), {}
    labeller = train(traces, settings.symbols, settings.num_copies, settings.doubt)
    if settings.num_own_plans:
        places = training_problems(settings.semantics)
        own = label_plans(seed, settings.family, places, labeller, settings.num_own_plans)
        labeller = train([*traces, *own], settings.symbols, settings.num_copies, settings.doubt)
    known = Knowledge(labeller, HumanModel.learn(traces), settings.alpha)
    judges = draw_participants(seed, settings.judges or settings.family, settings.num_judges)
    player, *_ = draw_participants((seed[0], seed[1] + _PLAYERS), settings.judges or settings.family, 1)
    rows = []
    for held in problems:
        place = _Place(seed, held, judges)
        for name in settings.plans:
            if name != "participants":
                rows.append(_planned(settings, place, name, known))
                continue
            played = games.get(held.name, []) if settings.traces else [place.play(player)]
            rows += [_played(settings, place, trace, known) for trace in played]
    return rows


def _simulated_traces(settings: Settings, seed: Seed) -> list[Trace]:
    return training_traces(
        seed, settings.family, settings.semantics, settings.num_traces, settings.noise, settings.way
    )


class _Place:
    """One problem, made ready to plan, to play and to judge."""

    def __init__(self, seed: Seed, held: HeldOutProblem, judges: Sequence[Participant]) -> None:
        self.seed, self.held, self.judges = seed, held, judges
        self.team = ground_team(held.problem)
        self.features = TeamFeatures(self.team)
        self.setting: Setting = prepare(held.problem)

    def chance(self, stream: int, number: int = 0) -> np.random.Generator:
        return np.random.default_rng((*self.seed, stream, self.held.number, number))

    def play(self, player: Participant) -> Trace:
        """Return a simulated participant's game."""
        return simulate(self.setting, player, self.chance(PLAYING)).trace

    def judged(self, actions: Sequence[GroundAtom]) -> list[list[Any]]:
        """Return name, explicable robot steps, and robot steps, by judge."""
        counts = []
        for number, judged_by in enumerate(self.judges):
            steps = judge(self.setting, judged_by, actions, self.chance(JUDGING, number))
            labels = [step.is_explicable for step in steps if step.is_explicable is not None]
            counts.append([judged_by.name, sum(labels), len(labels)])
        return counts


def _played(settings: Settings, place: _Place, trace: Trace, known: Knowledge) -> Row:
    """Return the row of a participant's own plan."""
    labels = [step.is_explicable for step in trace.steps if step.is_explicable is not None]
    row: Row = {"map": place.held.name, "plan": "participants", "outcome": "solved"}
    row["own_labels"] = [trace.annotator, sum(labels), len(labels)]
    return row | _scores(settings, place, trace.actions, known)


def _planned(settings: Settings, place: _Place, name: str, known: Knowledge) -> Row:
    """Return the row of a planner's plan."""
    if name == "ceiling":
        row: Row = {"map": place.held.name, "plan": name, "outcome": "solved"}
        return row | _scores(settings, place, plan_for_judges(place.setting, place.judges, EXTRA), known)
    found = PLANNERS[name](place.team, known)
    row = {"map": place.held.name, "plan": name, "outcome": found.outcome.value}
    row["search_s"] = round(found.search_s, 6)
    if found.plan is None:
        return row
    if found.objective is not None:
        row["is_proved"] = found.lower_bound >= found.objective * (1 - 1e-6)
    return row | _scores(settings, place, found.plan.actions, known)


def _scores(settings: Settings, place: _Place, actions: Sequence[GroundAtom], known: Knowledge) -> Row:
    """Measure a plan, have it judged, and keep it where pictures are wanted."""
    labelled = known.labeller.label(place.features, actions)
    row: Row = {
        "cost": place.team.task.execute(actions).cost,
        "num_steps": labelled.scores.paper.num_steps,
        "num_robot_steps": labelled.scores.robot.num_steps,
        "f_paper": labelled.scores.f_paper,
        "f_robot": labelled.scores.f_robot,
        "f_expected": labelled.scores.f_expected,
        "f_robot_expected": labelled.scores.f_robot_expected,
        "f_human": known.human.predict(place.features, actions).f_human,
        "judged": place.judged(actions),
    }
    if settings.keep_steps and place.seed[1] == 0:
        row["rows"] = list(place.held.world.rows)
        row["steps"] = [format_action(action) for action in actions]
        row["labels"] = [bool(label) for label in labelled.labels]
    return row

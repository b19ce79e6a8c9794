"""Team problems given as PDDL, whatever their domain."""

from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np

from explicable.evaluation.records import Row, Seed
from explicable.evaluation.trials.plans import PLANNERS, Knowledge
from explicable.evaluation.trials.training import (
    JUDGING,
    PLAYING,
    draw_participants,
    find_family,
    label_plans,
    train,
)
from explicable.execution import StudyWay, judge, prepare, simulate, simulate_study
from explicable.labelling.doubt import DEFAULT_DOUBT
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import read_team_problem
from explicable.planning import HumanModel
from explicable.planning.team_plan import DEFAULT_ALPHA

FILES = ("domain.pddl", "problem.pddl", "human-domain.pddl", "human-problem.pddl")
BUILTIN = ("rover-survey", "warehouse", "mast-inspection")
"""Team problems of the package; the examples show the first two at work."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What a trial depends on.

    Parameters
    ----------
    problem
        One of `BUILTIN`, or the folder where `FILES` are, seen from where the command is run.
    family
        Of all participants.
    num_traces
        To learn from, all of the same problem.
    way
        In which these games are played: ``commanded``, or ``mixed`` with games in which the robots go ahead
        unasked, as they do in many plans.
    doubt
        Of what no trace showed, in log odds a feature.
    num_own_plans
        Plans of planners, for the same problem, that participants have labelled too.
    num_judges
        Who judge the plans, and have had no part in training.
    alpha
        Price of an inexplicable step, in the unit of cost.
    plans
        Which planners, see `explicable.evaluation.trials.plans.PLANNERS`.
    """

    problem: str = "rover-survey"
    family: str = "mission"
    num_traces: int = 8
    way: StudyWay = "commanded"
    doubt: float = DEFAULT_DOUBT
    num_own_plans: int = 0
    num_judges: int = 3
    plans: tuple[str, ...] = ("ff", "greedy")
    alpha: float = DEFAULT_ALPHA


def measure(settings: Settings, seed: Seed) -> list[Row]:
    """Learn from participants' games, plan for the same problem, let others judge: one row a plan."""
    problem = _read(settings.problem)
    team, setting = ground_team(problem), prepare(problem)
    family = find_family(settings.family)
    chance = int(np.random.default_rng(seed).integers(2**31))
    episodes = simulate_study(
        [problem], family, num_traces=settings.num_traces, seed=chance, way=settings.way
    )
    traces = [episode.trace for episode in episodes]
    labeller = train(traces, doubt=settings.doubt)
    if settings.num_own_plans:
        own = label_plans(seed, settings.family, [problem], labeller, settings.num_own_plans)
        labeller = train([*traces, *own], doubt=settings.doubt)
    judges = draw_participants(seed, settings.family, settings.num_judges + 1)
    game = simulate(setting, judges[-1], np.random.default_rng((*seed, PLAYING)))
    plans = {"participants": game.trace.actions}
    known = Knowledge(labeller, HumanModel.learn(traces), settings.alpha)
    searches = {name: PLANNERS[name](team, known) for name in settings.plans}
    plans |= {name: found.plan.actions for name, found in searches.items() if found.plan is not None}
    rows = []
    for name, actions in plans.items():
        scores = labeller.label(team, actions).scores
        counts = []
        for number, who in enumerate(judges[:-1]):
            steps = judge(setting, who, actions, np.random.default_rng((*seed, JUDGING, number)))
            labels = [step.is_explicable for step in steps if step.is_explicable is not None]
            counts.append([who.name, sum(labels), len(labels)])
        rows.append(
            {
                "map": Path(settings.problem).name,
                "plan": name,
                "outcome": game.ending.value if name == "participants" else searches[name].outcome.value,
                "cost": team.task.execute(actions).cost,
                "num_steps": scores.paper.num_steps,
                "num_robot_steps": scores.robot.num_steps,
                "f_paper": scores.f_paper,
                "f_expected": scores.f_expected,
                "judged": counts,
            }
        )
    return rows


def _read(name: str) -> TeamProblem:
    """Read a team problem of the package or of a folder."""
    if name not in BUILTIN:
        return read_team_problem(*(Path(name) / file for file in FILES))
    with resources.as_file(resources.files("explicable.evaluation") / "domains" / name) as folder:
        return read_team_problem(*(folder / file for file in FILES))

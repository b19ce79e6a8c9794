"""What trials have in common: maps, simulated participants, and labellers trained on what these said."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from explicable.errors import TraceError, UsageError
from explicable.evaluation.best_plan import plan_best
from explicable.execution import (
    Family,
    Participant,
    StudyWay,
    builtin_families,
    judge,
    prepare,
    simulate_study,
)
from explicable.first_response import World, builtin_maps, encode, generate
from explicable.first_response.encoding import Semantics
from explicable.labelling import Labeller, Trace, read_traces
from explicable.labelling.doubt import DEFAULT_DOUBT
from explicable.labelling.traces import problem_checksum, split_traces
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.planning import TeamPlan, plan_classically

TRAINING, TESTING, JUDGING, PLAYING, LABELLING = range(5)
"""Streams of chance of one trial: the seed's third number."""
_JUDGES, _LABELLERS = 1000, 2000
"""Participants who judge plans, or label them, are counted from these on: who plays has a lower number."""
_NUM_LABELLERS = 8


def training_traces(
    seed: tuple[int, int],
    family: str,
    semantics: Semantics,
    num_traces: int,
    noise: float = -1.0,
    way: StudyWay = "mixed",
) -> list[Trace]:
    """Let simulated participants of a family play and label the training maps.

    Parameters
    ----------
    noise
        Probability that a label is the wrong way round, for all participants; negative: their own.
    way
        How they play, see `explicable.execution.simulate_study`. Commanded play alone never shows a robot
        that goes ahead unasked; under exclusive commands there is none, and the two are the same.
    """
    problems = training_problems(semantics)
    who = find_family(family)
    if noise >= 0:
        ranges = {name: ends for name, ends in who.ranges.items() if name != "noise"}
        who = replace(who, fixed={**who.fixed, "noise": noise}, ranges=ranges)
    chance = int(np.random.default_rng((*seed, TRAINING)).integers(2**31))
    episodes = simulate_study(problems, who, num_traces=num_traces, seed=chance, way=way)
    return [episode.trace for episode in episodes]


def training_problems(semantics: Semantics) -> list[TeamProblem]:
    """Return the maps that participants play and label, as team problems."""
    return [encode(world, semantics) for world in builtin_maps("training").values()]


def read_study(path: str, held: "Sequence[HeldOutProblem]") -> tuple[list[Trace], dict[str, list[Trace]]]:
    """Read a study's traces: those to learn from, and those of problems that no labeller may see, by name.

    Raises
    ------
    TraceError
        If the file is damaged, or no trace is left to learn from.
    """
    names = {problem_checksum(place.problem): place.name for place in held}
    traces: list[Trace] = []
    games: dict[str, list[Trace]] = {}
    for checksum, found in split_traces(read_traces(path), "problem").items():
        if checksum in names:
            games[names[checksum]] = found
        else:
            traces += found
    if not traces:
        raise TraceError("every trace is of a problem to plan for: none is left to learn from", path=path)
    return traces, games


def label_plans(
    seed: tuple[int, int], family: str, problems: Sequence[TeamProblem], labeller: Labeller, num: int
) -> list[Trace]:
    """Let participants label plans, FF's and explicable ones in turns, for one problem after another.

    Games in which the robot follows the person show only a part of what a planner may think of. Each of up to
    eight participants labels the plans of two problems, or, if there is but one, the two plans for it.

    Parameters
    ----------
    seed
        Of the trial.
    labeller
        For the explicable plans.
    num
        Traces wanted; a problem without a plan gives none.
    """
    traces = []
    who = find_family(family)
    people = [
        who.draw(_LABELLERS + k, np.random.default_rng((*seed, LABELLING, k))) for k in range(_NUM_LABELLERS)
    ]
    num_each = 4 if len(problems) > 1 else 2
    plans: dict[tuple[int, bool], TeamPlan] = {}
    for number in range(num):
        place, is_explicable = number // 2 % len(problems), number % 2 == 1
        if (place, is_explicable) not in plans:
            plans[place, is_explicable] = _plan(problems[place], labeller, is_explicable)
        planned, person = plans[place, is_explicable].plan, people[number // num_each % len(people)]
        if planned is not None:
            rng = np.random.default_rng((*seed, LABELLING, 1000 + number))
            steps = judge(prepare(problems[place]), person, planned.actions, rng)
            traces.append(Trace(problems[place], steps, person.name, "simulated"))
    return traces


def _plan(problem: TeamProblem, labeller: Labeller, is_explicable: bool) -> TeamPlan:
    team = ground_team(problem)
    if not is_explicable:
        return plan_classically(team, algorithm="ff")
    return plan_best(team, labeller)


def train(
    traces: list[Trace],
    symbols: Literal["lifted", "ground"] = "lifted",
    num_copies: int = 0,
    doubt: float = DEFAULT_DOUBT,
) -> Labeller:
    """Train a labeller; intervals are not asked of it here, so it needs no bootstrap."""
    return Labeller.train(traces, num_bootstrap=0, symbols=symbols, num_copies=num_copies, doubt=doubt)


def find_family(name: str) -> Family:
    """Return a built-in family of simulated participants.

    Raises
    ------
    UsageError
        If there is none of this name.
    """
    families = builtin_families()
    if name not in families:
        raise UsageError(f"there is no family {name!r} of simulated participants, but {', '.join(families)}")
    return families[name]


def draw_participants(seed: tuple[int, int], family: str, num: int) -> list[Participant]:
    """Draw participants who have had no part in training."""
    rng = np.random.default_rng((*seed, JUDGING))
    return [find_family(family).draw(_JUDGES + number, rng) for number in range(num)]


def maps_to_plan(seed: tuple[int, int], num_generated: int, side: int = 6) -> Iterator[tuple[str, World]]:
    """Yield the maps to plan for: the package's test maps, or, if any are asked for, generated ones."""
    if num_generated == 0:
        yield from builtin_maps("test").items()
    for number in range(num_generated):
        name = f"generated-{seed[0]}-{seed[1]}-{number}"
        yield name, generate(np.random.default_rng((*seed, TESTING, number)), height=side, width=side)


@dataclass(frozen=True, slots=True)
class HeldOutProblem:
    """A problem that no labeller has seen."""

    name: str
    number: int
    world: World
    problem: TeamProblem


def held_out(
    seed: tuple[int, int], semantics: Semantics, num_generated: int, side: int = 6
) -> Iterator[HeldOutProblem]:
    """Yield `maps_to_plan` as team problems."""
    for number, (name, world) in enumerate(maps_to_plan(seed, num_generated, side)):
        yield HeldOutProblem(name, number, world, encode(world, semantics))

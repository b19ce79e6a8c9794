"""What a game in closed loop may take, and what came of it."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

from explicable.execution.episodes import Episode
from explicable.execution.notices import Occurrence
from explicable.execution.position import Position
from explicable.labelling.records import Origin, Trace


@dataclass(frozen=True, slots=True)
class Limits:
    """How long a game waits for what.

    Parameters
    ----------
    max_steps
        Most steps of the whole team.
    plan_s
        Seconds after which a plan is late; then the robot goes on without it.
    step_s
        Seconds after which a robot is asked to give its step up; after as long again it is lost.
    game_s
        Seconds for the whole game.
    patience
        Events without a step of anybody after which nothing more is to be expected.
    """

    max_steps: int = 1000
    plan_s: float = 0.5
    step_s: float = 60.0
    game_s: float = math.inf
    patience: int = 60


USUAL_LIMITS = Limits()


@dataclass(frozen=True, slots=True)
class Run:
    """A closed-loop game played to its end.

    Parameters
    ----------
    episode
        The trace and how the game ended.
    occurrences
        Everything that happened, in order.
    num_deviations
        Steps of the person that were not the next predicted ones.
    num_changes
        Requests made while another was under way.
    planning_s
        How long each call of the planner took, in seconds; the first made the first plan, the others were
        replans.
    at_once
        Whether several agents could be about steps at a time.
    """

    episode: Episode
    occurrences: tuple[Occurrence, ...]
    num_deviations: int
    num_changes: int
    planning_s: tuple[float, ...]
    at_once: bool = False

    @classmethod
    def of(cls, game: Position, annotator: str, origin: Origin, planning_s: Iterable[float]) -> Self:
        """Return what came of a game that has ended.

        Raises
        ------
        UsageError
            If it has not.
        """
        ending = game.ending()
        trace = Trace(
            game.setting.problem, tuple(game.steps), annotator, origin, notes={"ending": ending.value}
        )
        return cls(
            Episode(trace, ending),
            tuple(game.occurrences),
            game.num_deviations,
            game.num_changes,
            tuple(planning_s),
            game.at_once,
        )

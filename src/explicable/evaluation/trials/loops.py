"""What decides in practice: the robot plans, a participant acts and judges, the robot plans again."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from explicable.errors import UsageError
from explicable.evaluation.records import Row, Seed
from explicable.evaluation.replanning import Prices
from explicable.evaluation.strategies import Strategy, play, strategies
from explicable.evaluation.trials.training import (
    PLAYING,
    draw_participants,
    find_family,
    held_out,
    train,
    training_traces,
)
from explicable.execution import Participant, Setting, SimulatedPerson, prepare
from explicable.planning.team_plan import DEFAULT_ALPHA

STRATEGIES = ("follower", "nearest", "ff", "explicable", "learning", "oracle")
"""See `explicable.evaluation.strategies.strategies`."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What a trial depends on; as in `explicable.evaluation.trials.plans.Settings`.

    Parameters
    ----------
    semantics, family, judges, num_traces, num_maps, alpha
        Of commands; of training; of those who play; traces; maps; price of an inexplicable step.
    num_players
        Participants who play each map with each strategy.
    strategies
        Those that are compared.
    """

    semantics: Literal["persistent", "exclusive"] = "exclusive"
    family: str = "myopic"
    judges: str = ""
    num_traces: int = 34
    num_maps: int = 0
    alpha: float = DEFAULT_ALPHA
    num_players: int = 3
    strategies: tuple[str, ...] = STRATEGIES

    def __post_init__(self) -> None:
        unknown = set(self.strategies) - set(STRATEGIES)
        if unknown:
            raise UsageError(
                f"unknown strategies {', '.join(sorted(unknown))}; known: {', '.join(STRATEGIES)}"
            )
        find_family(self.family)


def measure(settings: Settings, seed: Seed) -> list[Row]:
    """Play each map with each participant and each strategy, chance being the same: one row a game."""
    labeller = train(training_traces(seed, settings.family, settings.semantics, settings.num_traces))
    known = strategies(labeller, Prices(alpha=settings.alpha), improve_s=None)
    players = draw_participants(seed, settings.judges or settings.family, settings.num_players)
    rows = []
    for held in held_out(seed, settings.semantics, settings.num_maps):
        setting = prepare(held.problem)
        for number, player in enumerate(players):
            chance = (*seed, PLAYING, held.number, number)
            rows += [
                {"map": held.name, "player": player.name, "strategy": name}
                | _game(known[name], setting, player, np.random.default_rng(chance))
                for name in settings.strategies
            ]
    return rows


def _game(strategy: Strategy, setting: Setting, player: Participant, rng: np.random.Generator) -> Row:
    played = play(strategy, setting, SimulatedPerson(setting, player, rng))
    steps = played.episode.trace.steps
    labels = [step.is_explicable for step in steps if step.is_explicable is not None]
    return {
        "outcome": played.episode.ending.value,
        "num_steps": len(steps),
        "num_robot_steps": len(labels),
        "num_inexplicable": labels.count(False),
        "num_deviations": played.num_deviations,
        "num_changes": played.num_changes,
        "num_plans": len(played.planning_s),
        "planning_s": round(sum(played.planning_s), 6),
    }

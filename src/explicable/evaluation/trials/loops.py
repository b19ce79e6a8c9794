"""What decides in practice: the robot plans, a participant acts and judges, the robot plans again."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from explicable.errors import UsageError
from explicable.evaluation.trials.training import (
    PLAYING,
    draw_participants,
    find_family,
    held_out,
    train,
    training_traces,
)
from explicable.execution import (
    Participant,
    Planner,
    Proposal,
    Setting,
    SimulatedPerson,
    Situation,
    prepare,
    run,
    simulate,
)
from explicable.labelling import Labeller
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.model.team import TeamTask
from explicable.search import Outcome, SearchResult, search

if TYPE_CHECKING:
    from collections.abc import Callable

Row = dict[str, Any]
Seed = tuple[int, int]

STRATEGIES = ("follower", "autonomous", "ff", "greedy", "explicable")
"""How a robot may decide what to do.

- ``follower``: breadth-first search to what was last asked for, as in the study.
- ``autonomous``: the same, but the nearest room where nothing was asked for.
- ``ff``: FF's joint plan.
- ``greedy``: the first explicable plan (Eq. 4).
- ``explicable``: the joint plan of least ``cost + alpha * E[inexplicable steps]``.

``oracle`` is added: whichever of these is best for this very participant, with the same chance.
"""

GAME = ("outcome", "num_steps", "num_robot_steps", "num_inexplicable")
"""What is known of every game, whoever led it."""

PROOF_S = 60.0


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
        See `STRATEGIES`.
    """

    semantics: Literal["persistent", "exclusive"] = "exclusive"
    family: str = "myopic"
    judges: str = ""
    num_traces: int = 34
    num_maps: int = 0
    alpha: float = 1.0
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
    """Play each map with each participant and each strategy: one row a game."""
    labeller = train(training_traces(seed, settings.family, settings.semantics, settings.num_traces))
    players = draw_participants(seed, settings.judges or settings.family, settings.num_players)
    rows = []
    for held in held_out(seed, settings.semantics, settings.num_maps):
        setting = prepare(held.problem)
        robot = _Robot(ground_team(held.problem), labeller, settings.alpha)
        for number, player in enumerate(players):
            games = [
                _game(
                    strategy,
                    setting,
                    robot,
                    player,
                    np.random.default_rng((*seed, PLAYING, held.number, number)),
                )
                for strategy in settings.strategies
            ]
            best = min(games, key=lambda game: game["num_steps"] + settings.alpha * game["num_inexplicable"])
            games.append({name: best[name] for name in GAME} | {"strategy": "oracle"})
            rows += [{"map": held.name, "player": player.name} | game for game in games]
    return rows


class _Robot:
    """Plans the rest of a game."""

    def __init__(self, team: TeamTask, labeller: Labeller, alpha: float) -> None:
        self.team, self.labeller, self.alpha = team, labeller, alpha
        self.features = TeamFeatures(team)

    def planner(self, strategy: str) -> Planner:
        searches: dict[str, Callable[[Situation], SearchResult]] = {
            "ff": lambda now: search(self.team.task, "ff", initial_state=self._state(now)),
            "greedy": lambda now: search(
                self.team.task, initial_state=self._state(now), scorer=self._scorer(now)
            ),
            "explicable": lambda now: search(
                self.team.task,
                "anytime",
                initial_state=self._state(now),
                scorer=self._scorer(now),
                alpha=self.alpha,
                time_limit_s=PROOF_S,
            ),
        }
        if strategy == "follower":
            return lambda _: Proposal(Outcome.LIMIT)  # then the robot does what was last asked for
        return lambda now: self._proposal(searches[strategy](now))

    def _state(self, now: Situation) -> Any:
        return self.team.task.execute(now.past).states[-1]

    def _scorer(self, now: Situation) -> Any:
        return self.labeller.scorer(self.features, history=now.past)

    def _proposal(self, result: SearchResult) -> Proposal:
        operators = result.operators or ()
        return Proposal(result.outcome, tuple(self.team.task.action(operator) for operator in operators))


def _game(
    strategy: str, setting: Setting, robot: _Robot, player: Participant, rng: np.random.Generator
) -> Row:
    if strategy == "autonomous":
        episode = simulate(setting, player, rng, way="autonomous")
        planned: Row = {}
    else:
        played = run(setting, robot.planner(strategy), SimulatedPerson(setting, player, rng))
        episode = played.episode
        planned = {
            "num_deviations": played.num_deviations,
            "num_changes": played.num_changes,
            "num_plans": len(played.planning_s),
            "planning_s": round(sum(played.planning_s), 6),
        }
    labels = [step.is_explicable for step in episode.trace.steps if step.is_explicable is not None]
    return {
        "strategy": strategy,
        "outcome": episode.ending.value,
        "num_steps": len(episode.trace.steps),
        "num_robot_steps": len(labels),
        "num_inexplicable": labels.count(False),
    } | planned

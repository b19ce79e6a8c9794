"""The robot's strategies that are compared in closed loop (method page, section 7), each as a planner."""

import math
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from explicable.evaluation.oracle import OraclePlanner
from explicable.evaluation.replanning import (
    USUAL_PRICES,
    ExplicablePlanner,
    Grounding,
    LearningPlanner,
    Prices,
)
from explicable.execution import (
    Family,
    Participant,
    PersonFilter,
    Planner,
    Proposal,
    Run,
    Setting,
    SimulatedPerson,
    Situation,
    builtin_families,
    draw_evenly,
    run,
)
from explicable.labelling import Labeller
from explicable.model.grounding import ground
from explicable.model.task import State, Task
from explicable.search import Outcome, search

if TYPE_CHECKING:
    from explicable.model.team import TeamProblem

Strategy = Callable[[Setting, SimulatedPerson], Planner]
"""Makes a strategy's planner for one game; only the oracle looks at the person."""


def strategies(
    labeller: Labeller, prices: Prices = USUAL_PRICES, *, improve_s: float | None = 0.1
) -> dict[str, Strategy]:
    """Return all strategies that are compared, by name.

    ``follower``: a shortest way to what was last asked for; ``nearest``: without a request it heads for what
    can be had soonest; ``ff``: the joint plan of FF; ``explicable``: the explicable joint plan; ``learning``:
    the same, learning the person while working; ``oracle``: knows what the participant will hold against it.
    What depends on the map alone is made once for all games on it that follow one another.

    Parameters
    ----------
    labeller, prices, improve_s
        Of `ExplicablePlanner`.

    Examples
    --------
    >>> from explicable.labelling.crf import ConditionalRandomField
    >>> nothing_known = ConditionalRandomField.from_weights((True, False), [], [], [[0, 0], [0, 0]])
    >>> list(strategies(Labeller(nothing_known)))
    ['follower', 'nearest', 'ff', 'explicable', 'learning', 'oracle']
    """
    grounding = Grounding(labeller)

    def planner() -> ExplicablePlanner:
        return ExplicablePlanner(labeller, prices, improve_s=improve_s, grounding=grounding)

    acquaint = _Acquaintance()

    def learning(setting: Setting, person: SimulatedPerson) -> LearningPlanner:
        return LearningPlanner(planner(), acquaint(setting, person))

    classical, explicable = ClassicalPlanner(), planner()
    return {
        "follower": lambda _setting, _person: follow,
        "nearest": lambda setting, _person: NearestPlanner(setting),
        "ff": lambda _setting, _person: classical,
        "explicable": lambda _setting, _person: explicable,
        "learning": learning,
        "oracle": lambda setting, person: OraclePlanner(setting, person, prices.alpha),
    }


def play(strategy: Strategy, setting: Setting, person: SimulatedPerson, **options: Any) -> Run:
    """Play a game with a strategy; one that learns is shown what happens. Options are those of `run`."""
    planner = strategy(setting, person)
    if isinstance(planner, LearningPlanner):
        options["watch"] = planner.see
    return run(setting, planner, person, **options)


class _Acquaintance:
    """Makes filters whose guesses come from all families but the person's own."""

    def __init__(self) -> None:
        self._drawn: dict[tuple[str, ...], tuple[Participant, ...]] = {}

    @cached_property
    def _families(self) -> Mapping[str, Family]:
        return builtin_families()

    def __call__(self, setting: Setting, person: SimulatedPerson) -> PersonFilter:
        """Return a filter for a game."""
        others = tuple(name for name in self._families if f"-{name}-" not in person.name)
        if others not in self._drawn:
            drawn_from = [self._families[name] for name in others]
            self._drawn[others] = draw_evenly(drawn_from, np.random.default_rng(0))
        return PersonFilter(setting, self._drawn[others], np.random.default_rng(1))


def follow(situation: Situation) -> Proposal:  # noqa: ARG001 (a planner's signature)
    """Plan nothing: the robot then follows the last request by a shortest way, and predicts nobody.

    Examples
    --------
    >>> follow(Situation(None, (), (), b"")).outcome.value
    'limit reached'
    """
    return Proposal(Outcome.LIMIT)


class NearestPlanner:
    """Plans to fulfil the last request, then all that can be asked for, always what is nearest next."""

    def __init__(self, setting: Setting) -> None:
        self.truth = setting.truth

    def __call__(self, situation: Situation) -> Proposal:
        """Plan from here on."""
        truth, state, request = self.truth, situation.state, situation.request
        plan: list[int] = []
        while not truth.task.is_goal(state):
            way = truth.fulfilment_way(state, request) if request else None
            way, request = way or self._next_part(state), None
            if not way:
                return Proposal(Outcome.UNSOLVABLE)
            plan += way
            for operator in way:
                state = truth.task.successor(state, operator)
        return Proposal(Outcome.SOLVED, tuple(map(truth.task.action, plan)))

    def _next_part(self, state: State) -> tuple[int, ...] | None:
        truth = self.truth
        for cost, ask in truth.ranked_asks(state)[:1]:
            if cost < math.inf:
                request = truth.requests[truth.task.action(ask)]
                return (ask, *(truth.fulfilment_way(truth.task.successor(state, ask), request) or ()))
        return truth.mission_way(state)


class ClassicalPlanner:
    """The joint plan of FF, without regard to what the person expects."""

    def __init__(self) -> None:
        self._problem: TeamProblem | None = None
        self._task: Task | None = None

    def __call__(self, situation: Situation) -> Proposal:
        """Plan from here on."""
        if self._task is None or situation.problem is not self._problem:
            self._problem, self._task = situation.problem, ground(situation.problem.composite)
        task = self._task
        result = search(task, "ff", initial_state=task.execute(situation.past).states[-1])
        return Proposal(result.outcome, tuple(map(task.action, result.operators or ())))

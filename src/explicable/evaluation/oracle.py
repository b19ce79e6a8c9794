"""The oracle: a robot that looks into the simulated participant's mind, as no real robot can."""

import heapq
import itertools
import math
from typing import NamedTuple

from explicable.execution import Proposal, Setting, SimulatedPerson, Situation
from explicable.execution import mind as minds
from explicable.execution.mind import Mind
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request
from explicable.model.task import State
from explicable.planning.team_plan import DEFAULT_ALPHA
from explicable.search import Outcome

_MAX_EXPANSIONS = 20_000


class _Reached(NamedTuple):
    """A way that waits for its turn.

    Parameters
    ----------
    price, number
        What it goes by; of equal prices the first comes first.
    is_judged
        Whether the price has what the participant makes of the last step.
    state, before
        Where it leads, and where it led before its last step.
    mind
        Of the participant, before the last step.
    """

    price: float
    number: int
    is_judged: bool
    state: State
    before: State
    mind: Mind
    way: tuple[GroundAtom, ...]


class OraclePlanner:
    """Fulfils each request by the way of least ``cost + alpha * E[steps held against it]``.

    It knows what the participant believes now and by what rule it judges, and predicts that it asks next for
    what it would choose itself; what it will learn meanwhile and its mistakes are left out. With a request
    under way the rest after it is planned as by the participant's choice, request by request.
    """

    def __init__(self, setting: Setting, person: SimulatedPerson, alpha: float = DEFAULT_ALPHA) -> None:
        self.setting, self.person, self.alpha = setting, person, alpha

    def __call__(self, situation: Situation) -> Proposal:
        """Plan from here on."""
        state, mind = situation.state, self.person.mind
        plan: list[GroundAtom] = []
        while not self.setting.truth.task.is_goal(state):
            part = self._next_part(state, mind)
            if part is None:
                return Proposal(Outcome.LIMIT)
            for action in part:
                state, mind = self._after(state, mind, action)
            plan += part
        return Proposal(Outcome.SOLVED, tuple(plan))

    def _next_part(self, state: State, mind: Mind) -> tuple[GroundAtom, ...] | None:
        """Return the steps up to the next request, or up to what fulfils the present one."""
        truth = self.setting.truth
        if mind.request is not None:
            return self._best_way(state, mind, mind.request)
        asked = self._foresee(mind)
        if asked is not None and truth.after(state, asked) is not None:
            return (asked,)
        way = truth.mission_way(state)
        return (truth.task.action(way[0]),) if way else None

    def _foresee(self, mind: Mind) -> GroundAtom | None:
        """Return what the participant would choose, by the chance that it will then have."""
        chance = self.person.rng.bit_generator
        before = chance.state
        try:
            return minds.choose(self.setting, self.person.participant, mind, self.person.rng)
        finally:
            chance.state = before

    def _best_way(self, state: State, mind: Mind, request: Request) -> tuple[GroundAtom, ...] | None:
        """Dijkstra's algorithm over the true states; the mind goes along the best way to each.

        What a participant makes of a step is asked when its turn comes by its cost: often it never does.
        """
        setting, participant = self.setting, self.person.participant
        numbers = itertools.count()
        queue = [_Reached(0.0, next(numbers), True, state, state, mind, ())]
        least: dict[State, tuple[float, int]] = {}
        closed: set[State] = set()
        while queue and len(closed) < _MAX_EXPANSIONS:
            price, number, is_judged, here, before, seen, way = heapq.heappop(queue)
            fulfils = bool(way) and way[-1] in request.fulfilled_by
            if here in closed and not fulfils:
                continue
            if not is_judged:
                held = minds.regret(setting.belief, participant, seen, way[-1])
                paid = price + self.alpha * (1.0 - minds.acceptance(participant, held))
                if (paid, number) < least.get(here, (math.inf, 0)) or fulfils:
                    least[here] = min((paid, number), least.get(here, (math.inf, 0)))
                    heapq.heappush(queue, _Reached(paid, number, True, here, before, seen, way))
                continue
            if fulfils:
                return way
            closed.add(here)
            if way:
                seen = minds.watch(setting, seen, way[-1], before, here)
            for action, cost, after in setting.truth.robot_steps(here):
                if after not in closed:
                    entry = _Reached(price + cost, next(numbers), False, after, here, seen, (*way, action))
                    heapq.heappush(queue, entry)
        return None

    def _after(self, state: State, mind: Mind, action: GroundAtom) -> tuple[State, Mind]:
        after = self.setting.truth.after(state, action)
        if after is None:
            raise AssertionError(f"{action} is not possible there")
        return after, minds.watch(self.setting, mind, action, state, after)

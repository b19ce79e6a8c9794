"""What can be expected of a state: exact costs of fulfilling requests and of finishing the mission."""

import math
from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import NamedTuple

from explicable.execution import remembering
from explicable.execution.remembering import remember
from explicable.execution.stage import Stage
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request, find_requests
from explicable.model.task import State
from explicable.model.team import TeamProblem
from explicable.search import CostsToGo, Goal

_NO_END = math.inf, -1, ()


class _End(NamedTuple):
    """An operator that fulfils a request."""

    operator: int
    needs: Goal
    adds: frozenset[int]
    cost: int


class Outlook:
    """What follows from the states of one stage, found out once and remembered.

    Where steps lead, what can be asked for and at what cost: the course of a game, its robots and all who
    watch ask the same of it, and so do the next games.

    Attributes
    ----------
    requests
        What each human step asks for, by the step; steps that ask for nothing are not in it.
    fulfilling
        The robots' steps that fulfil any request.
    ahead
        Costs-to-go, by one of the stage's operators that settle a state to search from.
    """

    def __init__(self, problem: TeamProblem, stage: Stage) -> None:
        self.problem = problem
        self.stage = stage
        self.task = stage.task
        self.requests = find_requests(problem, stage.task)
        self.fulfilling = frozenset().union(*(request.fulfilled_by for request in self.requests.values()))
        self.ahead = CostsToGo(stage.task, remembering.MOST_REMEMBERED)
        self._steps: dict[tuple[State, GroundAtom], tuple[int, State] | None] = {}
        self._robot_steps: dict[State, tuple[tuple[GroundAtom, int, State], ...]] = {}
        self._is_goal: dict[State, bool] = {}
        self._stands: dict[tuple[State, frozenset[GroundAtom]], bool] = {}
        self._permits: dict[frozenset[GroundAtom], list[Goal]] = {}
        self._ranked: dict[State, tuple[tuple[float, int], ...]] = {}
        self._fulfilments: dict[tuple[State, GroundAtom], tuple[float, int, Goal]] = {}
        self._fulfilled: dict[tuple[State, GroundAtom], State] = {}
        self._ends = {action: self._ends_of(request) for action, request in self.requests.items()}
        self._served = {  # goals that fulfilling a request achieves
            action: frozenset(fact for end in ends for fact in end.adds if fact in self.task.goal)
            for action, ends in self._ends.items()
        }
        actions = list(enumerate(self.task.actions))
        self._operators: dict[GroundAtom, list[int]] = {}
        for operator, action in actions:
            if action:
                self._operators.setdefault(action, []).append(operator)
        self._asks = [
            (operator, self.requests[action]) for operator, action in actions if action in self.requests
        ]

    @cached_property
    def _robots(self) -> dict[int, GroundAtom]:
        """The robots' steps, by operator."""
        return {
            operator: action
            for operator, action in enumerate(self.task.actions)
            if action
            and " " not in action[0]  # such are the stage's
            and self.problem.agent_of(action).kind == "robot"
        }

    def step(self, state: State, action: GroundAtom) -> tuple[int, State] | None:
        """Return the operator of an action that can be executed here, and the state after it."""
        key = state, action
        try:
            return self._steps[key]
        except KeyError:
            core, step = self.task.core, None
            for operator in self._operators.get(action, ()):
                if core.is_applicable(state, operator):
                    step = operator, State(core.successor(state, operator))
                    break
            return remember(self._steps, key, step)

    def operator(self, state: State, action: GroundAtom) -> int | None:
        """Return the operator by which an action is executed here; None if it can't be."""
        step = self.step(state, action)
        return None if step is None else step[0]

    def after(self, state: State, action: GroundAtom) -> State | None:
        """Return the state after an action; None if it can't be executed here."""
        step = self.step(state, action)
        return None if step is None else step[1]

    def is_goal(self, state: State) -> bool:
        """Whether the goal holds."""
        known = self._is_goal.get(state)
        return remember(self._is_goal, state, self.task.is_goal(state)) if known is None else known

    def robot_steps(self, state: State) -> tuple[tuple[GroundAtom, int, State], ...]:
        """Return the steps that the robots can take here, what each costs, and the state after it."""
        steps = self._robot_steps.get(state)
        if steps is None:
            steps = tuple(
                (action, self.task.cost(operator), self.task.successor(state, operator))
                for operator in self.task.applicable(state)
                if (action := self._robots.get(operator))
            )
            remember(self._robot_steps, state, steps)
        return steps

    def follow(self, state: State, actions: Iterable[GroundAtom]) -> State | None:
        """Return the state after some actions; None if one of them can't be executed."""
        for action in actions:
            after = self.after(state, action)
            if after is None:
                return None
            state = after
        return state

    def stands(self, state: State, request: Request) -> bool:
        """Tell whether a request has not been withdrawn."""
        key = state, request.permits
        known = self._stands.get(key)
        if known is None:
            holds = self.task.core.holds
            known = any(holds(state, permit) for permit in self._permits_of(request))
            remember(self._stands, key, known)
        return known

    def _permits_of(self, request: Request) -> list[Goal]:
        """Return what a request's permits ask to hold: nothing, where one of them always holds."""
        permits = self._permits.get(request.permits)
        if permits is None:
            task, permits = self.task, []
            for atom in request.permits:
                fact = task.fact_number(atom)
                if fact is not None:
                    permits.append((fact,))
                elif task.holds(atom, task.initial_state):
                    permits.append(())
            self._permits[request.permits] = permits
        return permits

    def ranked_asks(self, state: State) -> tuple[tuple[float, int], ...]:
        """Rank the human operators that are applicable and ask for something the goal still lacks.

        A request brings the goal nearer if what fulfils it achieves one of its lacking parts, or lets the
        robots achieve one later that they could not achieve unasked.

        Returns
        -------
        tuple of (cost, operator)
            What asking and fulfilling cost together, cheapest first.
        """
        ranked = self._ranked.get(state)
        if ranked is None:
            ranked = remember(self._ranked, state, tuple(sorted(self._asks_nearer(state))))
        return ranked

    def _asks_nearer(self, state: State) -> Iterator[tuple[float, int]]:
        task = self.task
        lacking = frozenset(fact for fact in task.goal if not task.core.holds(state, [fact]))
        for operator, request in self._asks:
            if task.is_applicable(state, operator):
                asked = task.successor(state, operator)
                if self._brings_nearer(request, state, asked, lacking):
                    yield task.cost(operator) + self.fulfilment_cost(asked, request), operator

    def _brings_nearer(self, request: Request, state: State, asked: State, lacking: frozenset[int]) -> bool:
        """Tell whether a request serves any of the goals still lacking."""
        served = self._served[request.action]
        if served:
            return not served.isdisjoint(lacking)
        cost, alone = self.ahead.cost, self.stage.settle_alone
        return any(
            cost(state, (fact,), alone) == math.inf and cost(asked, (fact,), alone) < math.inf
            for fact in lacking
        )

    def fulfilment_cost(self, state: State, request: Request) -> float:
        """Return what it costs the robots alone to fulfil a request, the fulfilling step included."""
        return self._fulfilment(state, request)[0]

    def fulfilment_way(self, state: State, request: Request) -> tuple[int, ...] | None:
        """Return a best way for the robots alone to fulfil a request."""
        cost, wanted, needs = self._fulfilment(state, request)
        if cost == math.inf:
            return None
        return (*(self.ahead.way(state, needs, self.stage.settle_alone) or ()), wanted)

    def next_operator(self, state: State, request: Request) -> int | None:
        """Return the first operator of `fulfilment_way`, without walking the rest."""
        cost, wanted, needs = self._fulfilment(state, request)
        if cost == math.inf:
            return None
        first = self.ahead.first(state, needs, self.stage.settle_alone)
        return wanted if first is None else first

    def fulfilled(self, state: State, request: Request) -> State:
        """Return the state after `fulfilment_way`; as it is, if there is none."""
        key = state, request.action
        after = self._fulfilled.get(key)
        if after is None:
            after = self.task.follow(state, self.fulfilment_way(state, request) or ())
            remember(self._fulfilled, key, after)
        return after

    def mission_cost(self, state: State) -> float:
        """Return what it costs the team to reach its goal."""
        return self.ahead.cost(state, self.task.goal, self.stage.settle)

    def mission_way(self, state: State) -> tuple[int, ...] | None:
        """Return a best way for the team to reach its goal."""
        way = self.ahead.way(state, self.task.goal, self.stage.settle)
        return None if way is None else tuple(way)

    def _fulfilment(self, state: State, request: Request) -> tuple[float, int, Goal]:
        """Return the cost of a best way, the operator at its end, and what that one needs."""
        key = state, request.action
        found = self._fulfilments.get(key)
        if found is None:
            cost, alone = self.ahead.cost, self.stage.settle_alone
            ends = self._ends.get(request.action, ())  # another model's request may be beyond this one
            ways = [(cost(state, end.needs, alone) + end.cost, end.operator, end.needs) for end in ends]
            found = remember(self._fulfilments, key, min(ways, default=_NO_END))
        return found

    def _ends_of(self, request: Request) -> tuple["_End", ...]:
        task, core = self.task, self.task.core
        return tuple(
            _End(o, tuple(core.preconditions(o)), frozenset(core.adds(o)), task.cost(o))
            for action in sorted(request.fulfilled_by)
            for o in task.operators_of(action)
        )

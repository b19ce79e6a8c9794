"""What can be expected of a state: exact costs of fulfilling requests and of finishing the mission."""

import math
from collections.abc import Iterable
from typing import Literal, NamedTuple

from explicable.errors import ResourceError
from explicable.execution.stage import Stage
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request, find_requests
from explicable.model.task import State
from explicable.model.team import TeamProblem
from explicable.search import Outcome, SearchResult, search

Goal = tuple[int, ...]

_NONE = -1  # no operator: at the goal, or no way there
_TOUR_EVALUATIONS = 10_000  # a fraction of a second


class _End(NamedTuple):
    """An operator that fulfils a request."""

    operator: int
    needs: Goal
    adds: frozenset[int]
    cost: int


class Outlook:
    """Costs-to-go on one stage, each computed by A* once and remembered with the whole way found.

    Every state on an optimal way has its own optimal rest, so one search answers for all of them; an episode
    that keeps to the ways expected hardly ever searches.

    Attributes
    ----------
    requests
        What each human step asks for, by the step; steps that ask for nothing are not in it.
    """

    def __init__(self, problem: TeamProblem, stage: Stage) -> None:
        self.problem = problem
        self.stage = stage
        self.task = stage.task
        self.requests = find_requests(problem, stage.task)
        self._known: dict[tuple[State, Goal], tuple[float, int]] = {}
        self._operators: dict[GroundAtom, tuple[int, ...]] = {}  # of the actions asked about
        self._ends = {action: self._ends_of(request) for action, request in self.requests.items()}
        self._asks = [
            (operator, self.requests[action])
            for operator in range(self.task.num_operators)
            if (action := self.task.action(operator)) in self.requests
        ]

    def operator(self, state: State, action: GroundAtom) -> int | None:
        """Return the operator by which an action can be executed here, if it can."""
        operators = self._operators.get(action)
        if operators is None:
            operators = self._operators[action] = self.task.operators_of(action)
        is_applicable = self.task.core.is_applicable
        for operator in operators:
            if is_applicable(state, operator):
                return operator
        return None

    def follow(self, state: State, actions: Iterable[GroundAtom]) -> State | None:
        """Return the state after some actions; None if one of them can't be executed."""
        for action in actions:
            operator = self.operator(state, action)
            if operator is None:
                return None
            state = self.task.successor(state, operator)
        return state

    def stands(self, state: State, request: Request) -> bool:
        """Tell whether a request has not been withdrawn."""
        return any(self.task.holds(atom, state) for atom in request.permits)

    def ranked_asks(self, state: State) -> list[tuple[float, int]]:
        """Rank the human operators that are applicable and ask for something the goal still lacks.

        A request brings the goal nearer if what fulfils it achieves one of its lacking parts, or lets the
        robots achieve one later that they could not achieve unasked.

        Returns
        -------
        list of (cost, operator)
            What asking and fulfilling cost together, cheapest first.
        """
        task = self.task
        lacking = frozenset(fact for fact in task.goal if not task.core.holds(state, [fact]))
        ranked = []
        for operator, request in self._asks:
            if task.is_applicable(state, operator):
                asked = task.successor(state, operator)
                if self._brings_nearer(request, state, asked, lacking):
                    ranked.append((task.cost(operator) + self.fulfilment_cost(asked, request), operator))
        return sorted(ranked)

    def _brings_nearer(self, request: Request, state: State, asked: State, lacking: frozenset[int]) -> bool:
        """Tell whether a request serves any of the goals still lacking."""
        achieved = {fact for end in self._ends[request.action] for fact in end.adds}
        if not achieved.isdisjoint(self.task.goal):
            return not achieved.isdisjoint(lacking)
        unasked, when_asked = self.stage.robots_alone(state), self.stage.robots_alone(asked)
        return any(
            self._cost(unasked, (fact,)) == math.inf and self._cost(when_asked, (fact,)) < math.inf
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
        return (*self._way(self.stage.robots_alone(state), needs), wanted)

    def next_operator(self, state: State, request: Request) -> int | None:
        """Return the first operator of `fulfilment_way`, without walking the rest."""
        cost, wanted, needs = self._fulfilment(state, request)
        if cost == math.inf:
            return None
        first = self._known[self.stage.robots_alone(state), needs][1]
        return wanted if first == _NONE else first

    def mission_cost(self, state: State) -> float:
        """Return what it costs the team to reach its goal."""
        return self._cost(self.stage.with_humans(state), self.task.goal)

    def mission_way(self, state: State) -> tuple[int, ...] | None:
        """Return a best way for the team to reach its goal."""
        start = self.stage.with_humans(state)
        return None if self._cost(start, self.task.goal) == math.inf else self._way(start, self.task.goal)

    def _fulfilment(self, state: State, request: Request) -> tuple[float, int, Goal]:
        """Return the cost of a best way, the operator at its end, and what that one needs."""
        alone = self.stage.robots_alone(state)
        ends = self._ends.get(request.action, ())  # another model's request may be beyond this one
        ways = ((self._cost(alone, end.needs) + end.cost, end.operator, end.needs) for end in ends)
        return min(ways, default=(math.inf, _NONE, ()))

    def _ends_of(self, request: Request) -> tuple["_End", ...]:
        task, core = self.task, self.task.core
        return tuple(
            _End(o, tuple(core.preconditions(o)), frozenset(core.adds(o)), task.cost(o))
            for action in sorted(request.fulfilled_by)
            for o in task.operators_of(action)
        )

    def _cost(self, state: State, goal: Goal) -> float:
        if (state, goal) not in self._known:
            self._explore(state, goal)
        return self._known[state, goal][0]

    def _way(self, state: State, goal: Goal) -> tuple[int, ...]:
        way = []
        while (operator := self._known[state, goal][1]) != _NONE:
            way.append(operator)
            state = self.task.successor(state, operator)
        return tuple(way)

    def _explore(self, state: State, goal: Goal) -> None:
        result = self._search(state, goal)
        if result.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if result.outcome is Outcome.LIMIT:
            raise ResourceError(f"not enough memory for the exact cost-to-go in {self.task.problem.name}")
        if result.operators is None or result.cost is None:
            self._known[state, goal] = (math.inf, _NONE)
            return
        states = [state]
        for operator in result.operators:
            states.append(self.task.successor(states[-1], operator))
        # From the goal back, and what is known stays: so whatever is known leads to the goal, at any moment
        # in which another thread may look.
        remaining = 0
        self._known.setdefault((states.pop(), goal), (remaining, _NONE))
        for operator in reversed(result.operators):
            remaining += self.task.cost(operator)
            self._known.setdefault((states.pop(), goal), (remaining, operator))

    def _search(self, state: State, goal: Goal) -> SearchResult:
        # Most goals lie in one place or in several: a shortest tour of these says almost all there is to say.
        result = search(
            self.task,
            "astar",
            initial_state=state,
            goal=goal,
            heuristic="tour",
            max_evaluations=_TOUR_EVALUATIONS,
        )
        if result.limit != "evaluations":
            return result
        # A request mostly needs one thing, for which h_max is as good as LM-cut and much cheaper.
        heuristic: Literal["lmcut", "hmax"] = "lmcut" if goal == self.task.goal else "hmax"
        return search(self.task, "astar", initial_state=state, goal=goal, heuristic=heuristic)

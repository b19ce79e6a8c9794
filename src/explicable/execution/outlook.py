"""What can be expected of a state: exact costs of fulfilling requests and of finishing the mission."""

import math
from collections.abc import Iterable, Iterator
from itertools import repeat
from typing import Literal, NamedTuple, TypeVar

from explicable.errors import ResourceError
from explicable.execution.stage import Stage
from explicable.model.problem import GroundAtom
from explicable.model.requests import Request, find_requests
from explicable.model.task import State
from explicable.model.team import TeamProblem
from explicable.search import Outcome, Way, find_way, search

Goal = tuple[int, ...]

_NONE = -1  # no operator: at the goal, or no way there
MOST_REMEMBERED = 100_000
"""States about which one thing is remembered: a few ten megabytes."""

Key = TypeVar("Key")
Value = TypeVar("Value")


def remember(known: dict[Key, Value], key: Key, value: Value, most: int | None = None) -> Value:
    """Note what was found out, and return it; where too much is known, all else is forgotten.

    ``most``: how much may be known, by default `MOST_REMEMBERED`.

    Examples
    --------
    >>> known = {1: "one", 2: "two"}
    >>> remember(known, 3, "three", most=2), known
    ('three', {3: 'three'})
    """
    if len(known) >= (MOST_REMEMBERED if most is None else most):
        known.clear()
    known[key] = value
    return value


class _End(NamedTuple):
    """An operator that fulfils a request."""

    operator: int
    needs: Goal
    adds: frozenset[int]
    cost: int


class Outlook:
    """Costs-to-go on one stage, each computed by A* once and remembered with the whole way found.

    Every state on an optimal way has its own optimal rest, so one search answers for all of them; an episode
    that keeps to the ways expected hardly ever searches. What follows from a state (where a step leads, what
    can be asked for and at what cost) is remembered too: the course of a game, its robots and all who watch
    ask the same of it, and so do the next games.

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
        self._permits: dict[frozenset[GroundAtom], tuple[bool, list[Goal]]] = {}
        self._after: dict[tuple[State, GroundAtom], State | None] = {}
        self._robot_steps: dict[State, tuple[tuple[GroundAtom, int, State], ...]] = {}
        self._ranked: dict[State, tuple[tuple[float, int], ...]] = {}
        self._fulfilments: dict[tuple[State, GroundAtom], tuple[float, int, Goal]] = {}
        self._ends = {action: self._ends_of(request) for action, request in self.requests.items()}
        actions = [(operator, self.task.action(operator)) for operator in range(self.task.num_operators)]
        self._asks = [
            (operator, self.requests[action]) for operator, action in actions if action in self.requests
        ]
        self._robots = {
            operator: action
            for operator, action in actions
            if action
            and " " not in action[0]  # such are the stage's
            and problem.agent_of(action).kind == "robot"
        }

    def operator(self, state: State, action: GroundAtom) -> int | None:
        """Return the operator by which an action can be executed here, if it can."""
        is_applicable = self.task.core.is_applicable
        for operator in self.task.operators_of(action):
            if is_applicable(state, operator):
                return operator
        return None

    def after(self, state: State, action: GroundAtom) -> State | None:
        """Return the state after an action; None if it can't be executed here."""
        key = state, action
        try:
            return self._after[key]
        except KeyError:
            operator = self.operator(state, action)
            after = None if operator is None else self.task.successor(state, operator)
            return remember(self._after, key, after)

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
        permits = self._permits.get(request.permits)
        if permits is None:
            permits = self._permits[request.permits] = self._permits_of(request)
        always, facts = permits
        return always or any(map(self.task.core.holds, repeat(state), facts))

    def _permits_of(self, request: Request) -> tuple[bool, list[Goal]]:
        """Return whether one of a request's permits always holds, and those that may change."""
        task = self.task
        changing: list[Goal] = []
        for atom in request.permits:
            fact = task.fact_number(atom)
            if fact is not None:
                changing.append((fact,))
            elif task.holds(atom, task.initial_state):
                return True, []
        return False, changing

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
        first = self._known_from(self.stage.robots_alone(state), needs)[1]
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
        key = state, request.action
        found = self._fulfilments.get(key)
        if found is None:
            alone = self.stage.robots_alone(state)
            ends = self._ends.get(request.action, ())  # another model's request may be beyond this one
            ways = ((self._cost(alone, end.needs) + end.cost, end.operator, end.needs) for end in ends)
            found = remember(self._fulfilments, key, min(ways, default=(math.inf, _NONE, ())))
        return found

    def _ends_of(self, request: Request) -> tuple["_End", ...]:
        task, core = self.task, self.task.core
        return tuple(
            _End(o, tuple(core.preconditions(o)), frozenset(core.adds(o)), task.cost(o))
            for action in sorted(request.fulfilled_by)
            for o in task.operators_of(action)
        )

    def _cost(self, state: State, goal: Goal) -> float:
        return self._known_from(state, goal)[0]

    def _way(self, state: State, goal: Goal) -> tuple[int, ...]:
        way = []
        while (operator := self._known_from(state, goal)[1]) != _NONE:
            way.append(operator)
            state = self.task.successor(state, operator)
        return tuple(way)

    def _known_from(self, state: State, goal: Goal) -> tuple[float, int]:
        """Return the cost-to-go and the operator to begin with."""
        known = self._known.get((state, goal))
        return self._explore(state, goal) if known is None else known

    def _explore(self, state: State, goal: Goal) -> tuple[float, int]:
        if len(self._known) >= MOST_REMEMBERED:
            self._known.clear()
        task = self.task
        operators, states = find_way(task, state, goal) or self._search(state, goal)
        if not states:
            return self._known.setdefault((state, goal), (math.inf, _NONE))
        # From the goal back, and what is known stays: so whatever is known leads to the goal, at any moment
        # in which another thread may look.
        remaining, cost = 0, task.core.cost
        known = self._known.setdefault((states[-1], goal), (remaining, _NONE))
        for operator, before in zip(reversed(operators), reversed(states[:-1]), strict=True):
            remaining += cost(operator)
            known = self._known.setdefault((before, goal), (remaining, operator))
        return known

    def _search(self, state: State, goal: Goal) -> Way:
        # A request mostly needs one thing, for which h_max is as good as LM-cut and much cheaper.
        heuristic: Literal["lmcut", "hmax"] = "lmcut" if goal == self.task.goal else "hmax"
        result = search(self.task, "astar", initial_state=state, goal=goal, heuristic=heuristic)
        if result.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if result.outcome is Outcome.LIMIT:
            raise ResourceError(f"not enough memory for the exact cost-to-go in {self.task.problem.name}")
        if result.operators is None:
            return Way((), ())
        states = [state]
        for operator in result.operators:
            states.append(self.task.successor(states[-1], operator))
        return Way(result.operators, states)

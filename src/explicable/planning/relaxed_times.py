"""When things can be done at the earliest: exactly along a sequence, and relaxed for all that may follow.

The times of a node are those of `explicable.model.schedule`, as numbers: a step appended to the sequence
starts when its agent is free, what it needs is so, and nobody is in its way.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from explicable.model.durations import Durations
from explicable.model.problem import GroundAtom
from explicable.model.schedule import FactUse, fact_use
from explicable.model.task import State
from explicable.model.team import TeamTask

Times = NDArray[np.float64]

# Rows of a node's times, one column a fact. When it is true for those who need it; when the last that needed
# it, looked at it in a conditional effect, added it, deleted it is done.
_TRUE, _NEEDED, _LOOKED_AT, _ADDED, _DELETED = range(5)


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """A sequence of steps, by what matters for those that follow.

    Parameters
    ----------
    times
        Of shape (5, number of facts), in the unit of the durations; see above.
    free
        When each agent is done with its last step.
    start
        Of the last step; none that follows may start before it.
    """

    state: State
    times: Times
    free: Times
    start: float
    makespan: float
    operator: int = -1
    parent: "Node | None" = None

    def actions(self, action_of: Callable[[int], GroundAtom]) -> tuple[GroundAtom, ...]:
        """Return the sequence."""
        operators = []
        node: Node | None = self
        while node is not None and node.parent is not None:
            operators.append(node.operator)
            node = node.parent
        return tuple(map(action_of, reversed(operators)))

    def precedes(self, other: "Node") -> bool:
        """Whether everything that can follow another node of the same state can follow this one, as soon."""
        return bool(
            self.start <= other.start
            and self.makespan <= other.makespan
            and (self.free <= other.free).all()
            and (self.times <= other.times).all()
        )


class Timetable:
    """The steps of a task with their durations, agents and successors.

    Parameters
    ----------
    team_task
        The task.
    durations
        Of its steps.

    Attributes
    ----------
    is_exact
        False if the task has actions with disjunctive preconditions: a plan does not say by which disjunct a
        step is possible, so that not every order of start times can be relied upon.
    """

    def __init__(self, team_task: TeamTask, durations: Durations) -> None:
        self.task = task = team_task.task
        self.actions = actions = task.actions
        names = [agent.name for agent in team_task.problem.agents]
        # Auxiliary operators are nobody's steps: they get an agent of their own, who is always free.
        agents = [names.index(team_task.problem.agent_of(a).name) if a else len(names) for a in actions]
        self.num_agents = len(names) + 1
        self.agents = np.array(agents, dtype=np.intp)
        self.durations = np.array([durations.of(a) if a else 0.0 for a in actions])
        self.is_exact = len(set(actions)) == len(actions)
        self._uses: dict[int, _Columns] = {}

    def root(self) -> Node:
        """Return the empty sequence."""
        state = self.task.initial_state
        times = np.zeros((5, self.task.num_facts))
        times[_TRUE] = np.inf
        times[_TRUE, self.task.core.true_facts(state)] = 0.0
        return Node(state, times, np.zeros(self.num_agents), 0.0, 0.0)

    def children(self, node: Node) -> Iterator[Node]:
        """Give the sequences that are one step longer, the step starting no sooner than the last."""
        taken = set()
        for operator in self.task.applicable(node.state):
            action = self.actions[operator]
            if action and action not in taken:  # of several operators of one action, a plan takes the first
                taken.add(action)
                child = self._append(node, operator)
                if child is not None:
                    yield child

    def _append(self, node: Node, operator: int) -> Node | None:
        use, times, agent = self._use(node.state, operator), node.times, self.agents[operator]
        start = max(float(node.free[agent]), float(times[use.rows_before, use.facts_before].max(initial=0.0)))
        if start < node.start:
            return None
        end = start + float(self.durations[operator])
        after = times.copy()
        after[use.rows_after, use.facts_after] = np.maximum(after[use.rows_after, use.facts_after], end)
        after[_TRUE, use.deletes] = np.inf
        after[_TRUE, use.adds] = np.minimum(after[_TRUE, use.adds], end)
        free = node.free.copy()
        free[agent] = end
        state = self.task.successor(node.state, operator)
        return Node(state, after, free, start, max(node.makespan, end), operator, node)

    def _use(self, state: State, operator: int) -> "_Columns":
        if self.task.core.effects(operator):
            return _Columns(fact_use(self.task, state, operator))
        if operator not in self._uses:
            self._uses[operator] = _Columns(fact_use(self.task, state, operator))
        return self._uses[operator]


class _Columns:
    """Which times a step waits for, and which it sets, as index arrays."""

    def __init__(self, use: FactUse) -> None:
        before = [(_TRUE, fact) for fact in use.needs]
        before += [(row, fact) for fact in use.looks_at for row in (_ADDED, _DELETED)]
        before += [(row, fact) for fact in use.adds for row in (_DELETED, _LOOKED_AT)]
        before += [(row, fact) for fact in use.deletes for row in (_ADDED, _NEEDED, _LOOKED_AT)]
        after = [(_NEEDED, fact) for fact in use.needs] + [(_LOOKED_AT, fact) for fact in use.looks_at]
        after += [(_ADDED, fact) for fact in use.adds] + [(_DELETED, fact) for fact in use.deletes]
        self.rows_before, self.facts_before = _index(before)
        self.rows_after, self.facts_after = _index(after)
        self.adds = np.array(sorted(use.adds), dtype=np.intp)
        self.deletes = np.array(sorted(use.deletes), dtype=np.intp)


def _index(cells: list[tuple[int, int]]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    pairs = np.array(cells, dtype=np.intp).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


class RelaxedTimes:
    """h^max with durations, from the times of a node, for many nodes at once.

    Facts once true stay true, conditional effects always fire, and an agent, once free, can do any number of
    things at once. The longest chain to a goal is then a lower bound on the makespan.
    """

    def __init__(self, timetable: Timetable) -> None:
        self.timetable = timetable
        core = timetable.task.core
        num_facts, operators = timetable.task.num_facts, range(timetable.task.num_operators)
        always = num_facts  # a fact that is so from the start, for operators that need nothing
        self._needs = _Rows([core.preconditions(operator) or [always] for operator in operators])
        adders: list[list[int]] = [[] for _ in range(num_facts)]
        for operator in operators:
            for fact in {*core.adds(operator), *(f for effect in core.effects(operator) for f in effect[1])}:
                adders[fact].append(operator)
        self._added = np.array([fact for fact in range(num_facts) if adders[fact]], dtype=np.intp)
        self._adders = _Rows([adders[fact] for fact in self._added])

    @cached_property
    def _goal(self) -> NDArray[np.intp]:
        return np.array(self.timetable.task.goal, dtype=np.intp)

    def rate(self, nodes: Sequence[Node]) -> tuple[Times, Times]:
        """Rate nodes.

        Returns
        -------
        bounds, guides
            For each node: no schedule that goes on from it ends sooner; and the sum of the times at which
            the goals are reached, each on its own, in the relaxation.
        """
        facts = np.stack([node.times[_TRUE] for node in nodes])
        facts = np.concatenate([facts, np.zeros((len(nodes), 1))], axis=1)
        free = np.stack([node.free for node in nodes])
        start = np.array([node.start for node in nodes])
        earliest = np.maximum(free[:, self.timetable.agents], start[:, None])
        while True:
            ready = np.maximum(self._needs.reduce(np.maximum, facts), earliest)
            added = self._adders.reduce(np.minimum, ready + self.timetable.durations)
            sooner = np.minimum(facts[:, self._added], added)
            if (sooner == facts[:, self._added]).all():
                break
            facts[:, self._added] = sooner
        goals = facts[:, self._goal]
        makespans = np.array([node.makespan for node in nodes])
        return np.maximum(goals.max(axis=1, initial=0.0), makespans), goals.sum(axis=1)


class _Rows:
    """Rows of different lengths, none empty, over which columns are reduced."""

    def __init__(self, rows: Sequence[Sequence[int]]) -> None:
        lengths = np.array([len(row) for row in rows], dtype=np.intp)
        self._columns = np.array([column for row in rows for column in row], dtype=np.intp)
        self._offsets = np.concatenate([[0], np.cumsum(lengths)[:-1]]).astype(np.intp)

    def reduce(self, function: np.ufunc, values: Times) -> Times:
        """Reduce the columns of each row."""
        if not self._columns.size:
            return np.empty((len(values), 0))
        reduced: Times = function.reduceat(values[:, self._columns], self._offsets, axis=1)
        return reduced

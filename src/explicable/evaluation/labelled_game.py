"""A game as a labeller sees it: where it stands, what plans from there are worth, and what was found out."""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from explicable.execution.remembering import remember
from explicable.labelling import Labeller
from explicable.labelling.features import TeamFeatures
from explicable.model.plan import Actions
from explicable.model.problem import GroundAtom
from explicable.model.task import Execution, State
from explicable.search import SearchResult

MOST_REMEMBERED = 10_000
"""Plans and their prices, for each kind of game: a game in more situations begins to forget."""


class Place(NamedTuple):
    """Where a game stands.

    Parameters
    ----------
    state
        The state.
    context
        What the scorer keeps of the past.
    """

    state: State
    context: bytes


class LabelledGame:
    """A game as a labeller sees it: where it stands, and what the scorer keeps of the past.

    What was found out from some state after some past holds in the next games on the same map, too.
    """

    def __init__(self, features: TeamFeatures, labeller: Labeller) -> None:
        self.features, self.labeller = features, labeller
        self.problem, self.task = features.team.problem, features.task
        self.requests = features.requests
        self.scorer = labeller.scorer(features)
        self.searched: dict[tuple[Place, bool], SearchResult] = {}
        self._after: dict[tuple[Place, GroundAtom], Place | None] = {}
        self._objectives: dict[tuple[Place, Actions, float], float] = {}
        self._begin()

    def _begin(self) -> None:
        self.past: Actions = ()
        start = self.task.initial_state
        self._passed = [Place(start, self.scorer.root(start))]

    @property
    def place(self) -> Place:
        """Where it stands."""
        return self._passed[-1]

    def move_to(self, past: Actions) -> None:
        """Take the steps that are new since the last time; begin again if the past is another."""
        if past[: len(self.past)] != self.past:
            self._begin()
        execution = self.task.execute(past[len(self.past) :], self.place.state)
        self._passed = [*self._passed, *self._places(execution)]
        self.past = past

    def seems_inexplicable(self, number: int) -> bool:
        """Tell whether a step of the past looked inexplicable, rather than not, when it was done."""
        before, after = (
            self.scorer.score(context, state, [])[0] for state, context in self._passed[number : number + 2]
        )
        return after - before > 0.5

    def after(self, action: GroundAtom) -> Place | None:
        """Return where the game stands after one more step, or None if that is not possible."""
        key = self.place, action
        if key not in self._after:
            can_be = any(self.task.is_applicable(self.place.state, o) for o in self.task.operators_of(action))
            after = next(self._places(self.task.execute((action,), self.place.state))) if can_be else None
            remember(self._after, key, after, MOST_REMEMBERED)
        return self._after[key]

    def objective(self, plan: Actions, alpha: float) -> float:
        """Return ``cost + alpha * E[inexplicable steps]``, up to what the past has settled already."""
        key = self.place, plan, alpha
        if key not in self._objectives:
            execution = self.task.execute(plan, self.place.state)
            *_, end = (self.place, *self._places(execution))
            count, _, _ = self.scorer.score(end.context, end.state, [])
            remember(self._objectives, key, execution.cost + alpha * count, MOST_REMEMBERED)
        return self._objectives[key]

    def actions(self, result: SearchResult) -> Actions:
        """Return the plan that a search has found."""
        return tuple(map(self.task.action, result.operators or ()))

    def _places(self, execution: Execution) -> Iterator[Place]:
        """Yield where the game stands after each step of an execution from here on."""
        context = self.place.context
        for operator, (before, after) in zip(execution.operators, pairwise(execution.states), strict=True):
            context = self.scorer.extend(context, operator, before, after)
            yield Place(after, context)

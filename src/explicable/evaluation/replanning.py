"""The explicable planner in closed loop: given the past, true to what was announced, mindful of the person.

For a plan from now on it minimises

    J = cost + alpha * E[inexplicable steps | past] + beta * changes + gamma * (1 - p(next request))

where *changes* counts the announced steps that the plan does not keep (`explicable.execution.num_changes`),
and p is the probability that the person is believed to ask next for what the plan says. All prices are in the
unit of cost.
"""

from collections.abc import Iterator, Mapping
from copy import copy
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, Protocol

from explicable.execution import Course, PersonFilter, Proposal, Situation, adapt, num_changes
from explicable.execution.remembering import remember
from explicable.labelling import Labeller
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.model.plan import Actions
from explicable.model.problem import GroundAtom
from explicable.model.task import Execution, State
from explicable.model.team import TeamProblem
from explicable.planning import HumanModel
from explicable.search import Outcome, SearchResult, search

_NUM_PREDICTIONS = 4
"""Next requests for which plans are tried."""
_MOST_REMEMBERED = 10_000
"""Plans and their prices, for each kind of game: a game in more situations begins to forget."""


class Foresight(Protocol):
    """What the person is believed to do next."""

    def predict(self) -> Mapping[GroundAtom, float]:
        """Return the probability of each next request."""


@dataclass(frozen=True, slots=True)
class Prices:
    """What the parts of the objective cost, in the unit of cost.

    Parameters
    ----------
    alpha
        Of a step that is expected to be inexplicable.
    beta
        Of an announced step that is not kept.
    gamma
        Of a next request that is predicted and does not come: foresight mostly prevails.
    """

    alpha: float = 1.0
    beta: float = 0.1
    gamma: float = 10.0


USUAL_PRICES = Prices()


class Grounding:
    """Grounds a team problem once, for all planners that are asked about it one after the other.

    Parameters
    ----------
    labeller
        What a robot that has not met the person yet goes by: what is found out with it is kept for the next
        games, too.
    """

    def __init__(self, labeller: Labeller) -> None:
        self.labeller = labeller
        self._last: TeamFeatures | None = None
        self._game: LabelledGame | None = None

    def __call__(self, problem: TeamProblem) -> TeamFeatures:
        """Return the features of the steps of a problem's plans."""
        if self._last is None or self._last.team.problem is not problem:
            self._last = TeamFeatures(ground_team(problem))
        return self._last

    def game(self, problem: TeamProblem, labeller: Labeller) -> "LabelledGame":
        """Return a game as a labeller sees it."""
        features = self(problem)
        if labeller is not self.labeller:
            return LabelledGame(features, labeller)
        if self._game is None or self._game.features is not features:
            self._game = LabelledGame(features, labeller)
        return copy(self._game)


class ExplicablePlanner:
    """The explicable joint plan; see the module for its objective.

    It chooses between the announced plan, if that still leads to the goal, the plan of Eq. 4, the best that
    the anytime search finds within its budget and, with foresight, a plan for each of the most probable next
    requests. Of equally good ones it takes the first of these.

    Parameters
    ----------
    labeller
        What people find explicable: plans are sought by it.
    prices
        Of the parts of the objective.
    foresight
        What the person is believed to do next; None: no such term.
    human_model
        What people do, learned from traces: the foresight where there is no other.
    max_evaluations
        Budget of the anytime search, in states evaluated. 0: no such search.
    improve_s
        Seconds for the anytime search at most. Small tasks spend their budget long before. None: plans
        never depend on the machine.
    grounding
        Shared by planners whose games are on the same map.

    Attributes
    ----------
    judge
        What this person finds explicable, if more is known of that: the plans found are chosen from by it.
    """

    def __init__(
        self,
        labeller: Labeller,
        prices: Prices = USUAL_PRICES,
        *,
        foresight: Foresight | None = None,
        human_model: HumanModel | None = None,
        max_evaluations: int = 500,
        improve_s: float | None = 0.1,
        grounding: Grounding | None = None,
    ) -> None:
        self.labeller, self.prices = labeller, prices
        self.foresight, self.human_model = foresight, human_model
        self.max_evaluations, self.improve_s = max_evaluations, improve_s
        self.grounding = grounding or Grounding(labeller)
        self.judge: Labeller | None = None
        self._game: LabelledGame | None = None
        self._judged: LabelledGame | None = None

    def __call__(self, situation: Situation) -> Proposal:
        """Plan from here on."""
        game = self.game(situation)
        first = self._search(game, game.place)
        if first.operators is None:
            return Proposal(first.outcome)
        chances = self._chances(game, situation)
        plans = dict.fromkeys(self._alternatives(game, situation.announced, first, chances))
        judged = self._judged = self._at(situation, self.judge, self._judged) if self.judge else game

        def price(plan: Actions) -> float:
            prices = self.prices
            changed = prices.beta * num_changes(situation.announced, plan)
            asked = next((step for step in plan if step in game.requests), None)
            missed = prices.gamma * (1.0 - chances.get(asked, 0.0)) if chances and asked else 0.0
            return judged.objective(plan, prices.alpha) + changed + missed

        return Proposal(Outcome.SOLVED, min(plans, key=price))

    def game(self, situation: Situation) -> "LabelledGame":
        """Return the game as the labeller sees it, where it now stands."""
        self._game = self._at(situation, self.labeller, self._game)
        return self._game

    def _at(self, situation: Situation, labeller: Labeller, game: "LabelledGame | None") -> "LabelledGame":
        if game is None or game.problem is not situation.problem or game.labeller is not labeller:
            game = self.grounding.game(situation.problem, labeller)
        game.move_to(situation.past)
        return game

    def _chances(self, game: "LabelledGame", situation: Situation) -> Mapping[GroundAtom, float]:
        """Return how probable each next request is; empty: nothing is foreseen."""
        if self.foresight is not None:
            return self.foresight.predict()
        if self.human_model is not None:
            return self.human_model.next_steps(game.features, situation.past)
        return {}

    def _alternatives(
        self,
        game: "LabelledGame",
        announced: Actions,
        first: SearchResult,
        chances: Mapping[GroundAtom, float],
    ) -> Iterator[Actions]:
        if announced:
            yield announced
        yield game.actions(first)
        if 0 < self.max_evaluations >= first.evaluations:
            better = self._search(game, game.place, first)
            if better.operators is not None:
                yield game.actions(better)
        for request in sorted(chances, key=lambda step: -chances[step])[:_NUM_PREDICTIONS]:
            asked = game.after(request)
            rest = self._search(game, asked) if asked else None
            if rest and rest.operators is not None:
                yield (request, *game.actions(rest))

    def _search(
        self, game: "LabelledGame", place: "Place", first: SearchResult | None = None
    ) -> SearchResult:
        """Search for the plan of Eq. 4, or improve it with what it has left of the budget."""
        key = place, first is not None
        if key in game.searched:
            return game.searched[key]
        result = search(
            game.task,
            "anytime" if first else "default",
            scorer=game.scorer.starting_at(place.context),
            initial_state=place.state,
            alpha=self.prices.alpha,
            known_plans=[first.operators] if first and first.operators is not None else (),
            max_evaluations=self.max_evaluations - first.evaluations if first else None,
            time_limit_s=self.improve_s if first else None,
        )
        if result.outcome is Outcome.SOLVED:
            remember(game.searched, key, result, _MOST_REMEMBERED)
        return result


class LearningPlanner:
    """An explicable planner that learns the person while working; give `see` to `run` as ``watch``.

    When an answer was not what the labeller held for likely, it adapts the labeller to the answers given so
    far (`explicable.execution.adapt`), always from the same start: nothing builds up. It chooses by that
    between plans that are sought as for anybody. What the person will ask for next it takes from a filter.

    Parameters
    ----------
    planner
        Its judge and its foresight are replaced.
    person
        The filter; None: no foresight.
    adapts
        Whether to adapt the labeller.
    """

    def __init__(
        self, planner: ExplicablePlanner, person: PersonFilter | None = None, *, adapts: bool = True
    ) -> None:
        self.planner, self.person, self.adapts = planner, person, adapts
        self._course: Course | None = None
        self._num_heeded = 0
        planner.foresight = person

    def see(self, course: Course) -> None:
        """Look on at the game that is planned for."""
        self._course = course
        if self.person is not None:
            self.person.see(course)

    def __call__(self, situation: Situation) -> Proposal:
        """Plan from here on."""
        if self.adapts and self._course is not None:
            self._adapt(situation, self._course)
        return self.planner(situation)

    def _adapt(self, situation: Situation, course: Course) -> None:
        since = len(course.steps) - len(situation.past)
        answers = [step.is_explicable for step in course.steps[since:]]
        game = self.planner.game(situation)
        news = range(max(self._num_heeded - since, 0), len(answers))
        if any(answers[number] == game.seems_inexplicable(number) for number in news):
            self.planner.judge = adapt(self.planner.labeller, game.features, situation.past, answers)
        self._num_heeded = len(course.steps)


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
            remember(self._after, key, after, _MOST_REMEMBERED)
        return self._after[key]

    def objective(self, plan: Actions, alpha: float) -> float:
        """Return ``cost + alpha * E[inexplicable steps]``, up to what the past has settled already."""
        key = self.place, plan, alpha
        if key not in self._objectives:
            execution = self.task.execute(plan, self.place.state)
            *_, end = (self.place, *self._places(execution))
            count, _, _ = self.scorer.score(end.context, end.state, [])
            remember(self._objectives, key, execution.cost + alpha * count, _MOST_REMEMBERED)
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

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
from typing import Protocol

from explicable.evaluation.labelled_game import MOST_REMEMBERED, LabelledGame, Place
from explicable.execution import Course, PersonFilter, Proposal, Situation, adapt, num_changes
from explicable.execution.remembering import remember
from explicable.labelling import Labeller
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.model.plan import Actions
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem
from explicable.planning import HumanModel
from explicable.planning.team_plan import DEFAULT_ALPHA
from explicable.search import Outcome, SearchResult, search

_NUM_PREDICTIONS = 4
"""Next requests for which plans are tried."""


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

    alpha: float = DEFAULT_ALPHA
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

    def game(self, problem: TeamProblem, labeller: Labeller) -> LabelledGame:
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

    def game(self, situation: Situation) -> LabelledGame:
        """Return the game as the labeller sees it, where it now stands."""
        self._game = self._at(situation, self.labeller, self._game)
        return self._game

    def _at(self, situation: Situation, labeller: Labeller, game: LabelledGame | None) -> LabelledGame:
        if game is None or game.problem is not situation.problem or game.labeller is not labeller:
            game = self.grounding.game(situation.problem, labeller)
        game.move_to(situation.past)
        return game

    def _chances(self, game: LabelledGame, situation: Situation) -> Mapping[GroundAtom, float]:
        """Return how probable each next request is; empty: nothing is foreseen."""
        if self.foresight is not None:
            return self.foresight.predict()
        if self.human_model is not None:
            return self.human_model.next_steps(game.features, situation.past)
        return {}

    def _alternatives(
        self,
        game: LabelledGame,
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

    def _search(self, game: LabelledGame, place: Place, first: SearchResult | None = None) -> SearchResult:
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
            remember(game.searched, key, result, MOST_REMEMBERED)
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
        """Take in the answers to the steps of the past."""
        steps, past = tuple(course.steps), situation.past
        actions = tuple(step.action for step in steps)
        # The game may have gone on since the planner was called.
        starts = range(len(steps) - len(past), -1, -1)
        since = next((start for start in starts if actions[start : start + len(past)] == past), None)
        if since is None:
            return
        answers = [step.is_explicable for step in steps[since : since + len(past)]]
        game = self.planner.game(situation)
        news = range(max(self._num_heeded - since, 0), len(past))
        if any(answers[number] == game.seems_inexplicable(number) for number in news):
            self.planner.judge = adapt(self.planner.labeller, game.features, past, answers)
        self._num_heeded = since + len(past)

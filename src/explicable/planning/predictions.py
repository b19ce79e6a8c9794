"""Human steps are predictions: how plausible they are under a model of the person's choices.

A joint plan decides what the person will do. A planner may then look good by giving the person convenient
orders: all at once before the start, or the room first that the robot happens to pass. So the person's steps
are scored as well. From traces is learned, by one conditional logit (`explicable.labelling.choices`),

- whether the person acts or waits, given whether something asked for is still open, and
- which of the human steps possible then it is, by what the person believes.

The probability of a human step is the product of the two; ``F_human`` is its mean over a plan's human steps
(method page, section 2). Learned on one task, it holds for every other: no feature names an object.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

from explicable.errors import UsageError
from explicable.model.grounding import ground_team
from explicable.model.problem import GroundAtom
from explicable.model.task import State
from explicable.planning.beliefs import applicable_operator, watch
from explicable.planning.observer import CostToGo

if TYPE_CHECKING:
    from explicable.labelling import Trace
    from explicable.labelling.choices import ChoiceModel
    from explicable.labelling.features import TeamFeatures
    from explicable.model.team import TeamTask

Alternative = dict[str, float]


@dataclass(frozen=True, slots=True)
class PredictedSteps:
    """How plausible the human steps of a plan are.

    Attributes
    ----------
    probabilities
        Of each human step; None for robots' steps.
    """

    probabilities: tuple[float | None, ...]

    @property
    def f_human(self) -> float | None:
        """Mean probability of the human steps; None if there are none."""
        found = [p for p in self.probabilities if p is not None]
        return sum(found) / len(found) if found else None

    @property
    def log_probability(self) -> float | None:
        """Mean log-probability of the human steps, in nats; None if there are none."""
        found = [math.log(p) if p > 0 else -math.inf for p in self.probabilities if p is not None]
        return sum(found) / len(found) if found else None


@dataclass(frozen=True, slots=True)
class HumanModel:
    """A model of what a person does next; see `learn`.

    Examples
    --------
    The person orders the nearest room, waits until it is visited, and only then orders the other:

    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.labelling import LabelledStep, Trace
    >>> near, far = ("command", "person", "c-0-1"), ("command", "person", "c-0-3")
    >>> first = [("move", "r1", "c-0-0", "c-0-1"), ("visit-room", "r1", "c-0-1")]
    >>> second = [("move", "r1", "c-0-1", "c-0-2"), ("move", "r1", "c-0-2", "c-0-3")]
    >>> natural = [near, *first, far, *second, ("visit-room", "r1", "c-0-3")]
    >>> convenient = [far, near, *natural[1:3], *natural[4:]]
    >>> problem = encode(World(("@*.*",)))
    >>> steps = tuple(LabelledStep(problem.agent_of(action).name, action) for action in natural)
    >>> human = HumanModel.learn([Trace(problem, steps, "anna", "person")] * 10)
    >>> team_task = ground_team(problem)
    >>> [round(human.predict(team_task, plan).f_human, 1) for plan in (natural, convenient)]
    [1.0, 0.0]
    """

    model: "ChoiceModel"

    @classmethod
    def learn(cls, traces: "Iterable[Trace]", *, c2: float = 0.1) -> Self:
        """Learn from the human steps of traces.

        Parameters
        ----------
        traces
            Of any problems and people. Labels do not matter.
        c2
            Weight of the L2 penalty.

        Raises
        ------
        UsageError
            If no trace has a human step.
        PlanError
            If a trace can't be executed in its problem.
        """
        from explicable.labelling.choices import ChoiceModel
        from explicable.labelling.features import TeamFeatures

        walks: dict[int, _Situations] = {}
        choice_sets: list[list[Alternative]] = []
        chosen: list[int] = []
        has_human_step = False
        for trace in (traces := list(traces)):
            if id(trace.problem) not in walks:
                walks[id(trace.problem)] = _Situations(TeamFeatures(ground_team(trace.problem)))
            for situation in walks[id(trace.problem)].walk(trace.actions):
                choice_sets.append(situation.turn)
                chosen.append(int(situation.step is not None))
                if situation.step is not None:
                    has_human_step = True
                    choice_sets.append(situation.options)
                    chosen.append(situation.step)
        if not has_human_step:
            raise UsageError("no trace has a human step: there is nothing to learn from")
        return cls(ChoiceModel.fit(choice_sets, chosen, c2=c2))

    def predict(self, team: "TeamTask | TeamFeatures", actions: Sequence[GroundAtom]) -> PredictedSteps:
        """Return how probable each human step of a plan is, given all steps before it.

        Raises
        ------
        PlanError
            If a step is not applicable.
        """
        from explicable.labelling.features import TeamFeatures

        features = team if isinstance(team, TeamFeatures) else TeamFeatures(team)
        probabilities: list[float | None] = [None] * len(actions)
        for situation in _Situations(features).walk(actions):
            if situation.step is not None:
                acts, which = self.model.predict_probabilities([situation.turn, situation.options])
                probabilities[situation.number] = float(acts[1] * which[situation.step])
        return PredictedSteps(tuple(probabilities))


@dataclass(frozen=True, slots=True)
class _Situation:
    """A point of a plan at which the person can act.

    Parameters
    ----------
    number
        Of the step that follows.
    turn
        Features of waiting and of acting.
    options
        Features of the human steps possible.
    step
        Which of them follows; None if the person waits.
    """

    number: int
    turn: list[Alternative]
    options: list[Alternative]
    step: int | None


class _Situations:
    """Finds the situations of plans of one task, and remembers what fulfilling requests costs."""

    def __init__(self, features: "TeamFeatures") -> None:
        self.features = features
        self.team = features.team
        self.tables = features.tables
        self._fulfilling = self._find_fulfilling()
        self._costs: dict[tuple[int, ...], CostToGo] = {}

    def walk(self, actions: Sequence[GroundAtom]) -> Iterator[_Situation]:
        """Yield every situation of a plan in which some human step is possible."""
        task, tables = self.team.task, self.tables
        execution = task.execute(actions)
        believed = watch(self.team, actions).states
        waiting: list[int] = []  # requests not yet fulfilled nor withdrawn
        asked_before: set[int] = set()
        for number, operator in enumerate(execution.operators):
            state = execution.states[number]
            waiting = [r for r in waiting if self.features.stands(r, state)]
            possible = {
                task.action(o): o for o in task.applicable(state) if task.action(o) and tables.is_human(o)
            }
            step = list(possible).index(actions[number]) if tables.is_human(operator) else None
            if possible:
                turn: list[Alternative] = [{f"waits, {'a request' if waiting else 'nothing'} open": 1.0}, {}]
                options = self._options(possible.values(), believed[number], waiting, asked_before)
                yield _Situation(number, turn, options, step)
            if tables.is_human(operator):
                asked = tables.asks_for(operator)
                if asked >= 0:
                    waiting = [*(r for r in waiting if r != asked), asked]
                    asked_before.add(asked)
            else:
                waiting = [r for r in waiting if r not in tables.fulfils(operator)]

    def _options(
        self, operators: Iterable[int], believed: State, waiting: Sequence[int], asked_before: set[int]
    ) -> list[Alternative]:
        """Return the features of human steps, in the light of what the person believes."""
        rows = []
        for operator in operators:
            asked = self.tables.asks_for(operator)
            rows.append((asked, self._cost(operator, asked, believed) if asked >= 0 else math.inf))
        ranks = sorted({cost for asked, cost in rows if asked >= 0 and cost < math.inf})
        options: list[Alternative] = []
        for asked, cost in rows:
            option: Alternative = {}
            if asked < 0:
                option["asks for nothing"] = 1.0
            elif cost == math.inf:
                option["asks for what seems impossible"] = 1.0
            else:
                option["rank of the distance"] = float(ranks.index(cost))
                option["asks for the nearest"] = float(cost == ranks[0])
            if asked in waiting:
                option["repeats an open request"] = 1.0
            elif asked in asked_before:
                option["asks again"] = 1.0
            options.append(option)
        return options

    def _cost(self, operator: int, request: int, believed: State) -> float:
        """Return what it costs to fulfil a request from where the person believes things to stand."""
        mental = self.team.mental
        asking = applicable_operator(mental, believed, self.team.task.action(operator))
        state = believed if asking is None else mental.successor(believed, asking)
        least = math.inf
        for needs, cost in self._fulfilling.get(request, ()):
            if needs not in self._costs:
                self._costs[needs] = CostToGo(replace(mental, goal=needs, goal_reachable=True))
            least = min(least, cost + self._costs[needs](state))
        return least

    def _find_fulfilling(self) -> dict[int, set[tuple[tuple[int, ...], int]]]:
        """For each request: what the mental model's steps that fulfil it need, and their cost."""
        task, mental, tables = self.team.task, self.team.mental, self.tables
        found: dict[int, set[tuple[tuple[int, ...], int]]] = {}
        for operator in range(task.num_operators):
            action = task.action(operator)
            if action and not tables.is_human(operator):
                for request in tables.fulfils(operator):
                    found.setdefault(request, set()).update(
                        (tuple(mental.core.preconditions(o)), mental.cost(o))
                        for o in mental.operators_of(action)
                    )
        return found

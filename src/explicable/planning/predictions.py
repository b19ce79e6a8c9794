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
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from explicable.errors import UsageError
from explicable.model.grounding import ground_team
from explicable.model.problem import GroundAtom

if TYPE_CHECKING:
    from explicable.labelling import Trace
    from explicable.labelling.choices import ChoiceModel
    from explicable.labelling.features import TeamFeatures
    from explicable.model.team import TeamTask


@dataclass(frozen=True, slots=True)
class PredictedSteps:
    """How plausible the human steps of a plan are.

    Attributes
    ----------
    probabilities
        Of each human step; None for robots' steps.
    surprise
        ``-log p`` of all that the plan makes the person do, waiting included, in nats: what a plan is charged
        for (`explicable.planning.plan_explicably`).
    """

    probabilities: tuple[float | None, ...]
    surprise: float

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
        from explicable.labelling.situations import situations

        teams: dict[int, TeamFeatures] = {}
        choice_sets: list[Sequence[Mapping[str, float]]] = []
        chosen: list[int] = []
        has_human_step = False
        for trace in (traces := list(traces)):
            if id(trace.problem) not in teams:
                teams[id(trace.problem)] = TeamFeatures(ground_team(trace.problem))
            for situation in situations(teams[id(trace.problem)], trace.actions):
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
        from explicable.labelling.situations import situations

        features = team if isinstance(team, TeamFeatures) else TeamFeatures(team)
        probabilities: list[float | None] = [None] * len(actions)
        surprise = 0.0
        for situation in situations(features, actions):
            turn, which = self.model.predict_probabilities([situation.turn, situation.options])
            if situation.step is None:
                surprise += _nats(turn[0])
            else:
                probability = float(turn[1] * which[situation.step])
                probabilities[situation.number] = probability
                surprise += _nats(turn[1]) + _nats(which[situation.step])
        return PredictedSteps(tuple(probabilities), surprise)

    def next_steps(
        self, team: "TeamTask | TeamFeatures", actions: Sequence[GroundAtom] = ()
    ) -> dict[GroundAtom, float]:
        """Return what the person does next after these steps, if it acts: the probability of each step.

        Raises
        ------
        PlanError
            If a step is not applicable.

        Examples
        --------
        >>> from explicable.first_response.encoding import encode
        >>> from explicable.first_response.world import World
        >>> from explicable.labelling.choices import ChoiceModel
        >>> import numpy as np
        >>> human = HumanModel(ChoiceModel(("asks for the nearest",), np.array([3.0])))
        >>> chances = human.next_steps(ground_team(encode(World(("@*.*",)))))
        >>> {step[-1]: round(chance, 2) for step, chance in sorted(chances.items())}
        {'c-0-1': 0.95, 'c-0-3': 0.05}
        """
        from explicable.labelling.features import TeamFeatures
        from explicable.labelling.situations import options_after

        steps, options = options_after(
            team if isinstance(team, TeamFeatures) else TeamFeatures(team), actions
        )
        if not steps:
            return {}
        (chances,) = self.model.predict_probabilities([options])
        return dict(zip(steps, chances.tolist(), strict=True))


def _nats(probability: float) -> float:
    return -math.log(probability) if probability > 0 else math.inf

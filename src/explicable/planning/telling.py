"""Conform or explain: plan as the person expects, or tell them something on the way, whichever is cheaper.

Telling is a step of the plan with a cost of its own,

    J = cost + alpha * E[number of inexplicable steps] + telling_cost * number of differences told,

and each step is labelled under the mental model that the person has by then. Balancing the two in one
objective follows Chakraborti, Sreedharan & Kambhampati, "Balancing explicability and explanations in
human-aware planning" (IJCAI 2019), with the labeller in the place of optimality. What has been told is one
more variable of the task (`explicable.labelling.knowing`), so that one search settles what to do, what to
tell, and when.
"""

import itertools
import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.plan import JointPlan, format_action
from explicable.model.team import TeamTask
from explicable.planning.differences import Difference, find_differences
from explicable.planning.explanation import explain, tell
from explicable.planning.planner import check_alpha, joint_plan, plan_explicably
from explicable.search import Outcome, search

if TYPE_CHECKING:
    from explicable.labelling import Labeller
    from explicable.labelling.features import TeamFeatures
    from explicable.planning.predictions import HumanModel

_AS_GOOD = 1e-9  # differences in J that are but rounding
_MOST_SETS = 64  # for each of which the mental model is grounded and compiled


@dataclass(frozen=True, slots=True)
class Telling:
    """A step of a plan by which a robot tells the person of one difference between the two models.

    Attributes
    ----------
    before_step
        It comes right before this step of the plan, counted from 0 without the tellings.
    agent
        The robot that tells: the one that acts next.
    difference
        What it tells.
    """

    before_step: int
    agent: str
    difference: Difference

    def __str__(self) -> str:
        words = str(self.difference).replace("(", "").replace(")", "")
        return f"(tell {self.agent} {words})"


@dataclass(frozen=True, slots=True)
class ToldPlan:
    """A plan, and what the person is told in the course of it.

    Attributes
    ----------
    outcome
        Solved if there is a plan; else why there is none.
    plan
        The joint plan without the tellings, as the composite task executes it.
    tellings
        What the person is told, in order; empty if conforming is cheaper.
    probabilities
        Of each step of ``plan``: that it is expected, given what the person knows by then.
    objective
        J, telling included.
    lower_bound
        No plan has a lower J, among those that tell what was tried; 0 if nothing is known.
    objective_untold
        J of the best plan found without telling.
    is_complete
        Whether all sets of differences up to the size allowed could be told, but for those too dear to pay.
    """

    outcome: Outcome
    plan: JointPlan | None
    tellings: tuple[Telling, ...]
    probabilities: tuple[float, ...]
    objective: float | None
    lower_bound: float
    objective_untold: float | None
    is_complete: bool

    @property
    def told(self) -> tuple[Difference, ...]:
        """What the person is told, in order."""
        return tuple(telling.difference for telling in self.tellings)

    @property
    def lines(self) -> tuple[str, ...]:
        """The steps as text, tellings among them."""
        if self.plan is None:
            return ()
        lines: list[str] = []
        for number, action in enumerate((*self.plan.actions, None)):
            lines += [str(telling) for telling in self.tellings if telling.before_step == number]
            lines += [format_action(action)] if action else []
        return tuple(lines)


def conform_or_explain(
    team_task: TeamTask,
    labeller: "Labeller",
    *,
    alpha: float = 1.0,
    telling_cost: float = 1.0,
    max_told: int = 2,
    improve_s: float = 1.0,
    time_limit_s: float = 10.0,
    human_model: "HumanModel | None" = None,
    human_step_weight: float = 0.0,
    seed: int = 0,
) -> ToldPlan:
    """Find the cheapest of plans that conform to what the person expects, or that tell them something.

    The best explicable plan without telling comes first. What can be told are all differences between the two
    models; where their sets are too many (more than 64), those come first that explain unexpected steps of
    that plan and of the cheapest one. A set is left out if its telling alone, with the least that any plan
    costs, is no better than the plan without telling. Then one anytime search goes over plans and what is
    told in them together: on small tasks its answer is proved best.

    Parameters
    ----------
    alpha
        Price of one inexplicable step, in the unit of cost.
    telling_cost
        Price of telling one difference, in the unit of cost.
    max_told
        Largest number of differences that a plan tells.
    improve_s
        Seconds for the improvement of the plan without telling, and of that with it.
    time_limit_s
        Seconds for it all; half of them at most to prepare what can be told.
    human_model, human_step_weight
        As in `plan_explicably`.
    seed
        Of the searches.

    Raises
    ------
    UsageError
        If a price is negative, infinite or not a number, or the size is negative.
    LabellerError
        If the labeller was trained on another domain.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.labelling.crf import ConditionalRandomField
    >>> from explicable.labelling.labeller import Labeller
    >>> from explicable.model.grounding import ground_team
    >>> weights = ["request: move farther"], [[-5.0, 0.0]], [[0, 0], [0, 0]]
    >>> labeller = Labeller(ConditionalRandomField.from_weights([True, False], *weights), schemas=["move"])
    >>> team_task = ground_team(encode(World(("@x*", "...")), "exclusive"))
    >>> result = conform_or_explain(team_task, labeller, alpha=20.0, telling_cost=0.5)
    >>> print(*result.lines[:3], sep="; ")
    (command person c-0-2); (tell r1 clear c-0-1 does not hold); (move r1 c-0-0 c-1-0)
    """
    check_alpha(alpha)
    if not math.isfinite(telling_cost) or telling_cost < 0 or max_told < 0:
        raise UsageError("the cost of telling must be finite, and neither it nor the size of a set negative")
    deadline = time.monotonic() + time_limit_s
    plain = plan_explicably(
        team_task,
        labeller,
        alpha=alpha,
        improve_s=improve_s,
        time_limit_s=time_limit_s,
        human_model=human_model,
        human_step_weight=human_step_weight,
        seed=seed,
    )
    if plain.plan is None or plain.labelled is None or plain.objective is None:
        return ToldPlan(plain.outcome, None, (), (), None, 0.0, None, is_complete=True)
    weighed = _Weighed(plain.plan, (), plain.labelled.probabilities, plain.objective)
    cheapest = search(team_task.task, "anytime", time_limit_s=improve_s, seed=seed)
    affordable = plain.objective - cheapest.lower_bound
    while max_told > 0 and telling_cost * max_told >= affordable:
        max_told -= 1
    plans = [plain.plan, *([] if cheapest.operators is None else [_plan_of(team_task, cheapest.operators)])]
    left_s = deadline - time.monotonic()
    candidates = _candidates(team_task, labeller, plans, max_told, left_s / 4)
    people = _People(team_task, labeller, candidates)
    is_complete = people.learn(max_told, deadline - left_s / 2)
    told = people.plan(
        alpha,
        telling_cost,
        time_limit_s=max(min(improve_s, deadline - time.monotonic()), 0.0),
        human_model=human_model,
        human_step_weight=human_step_weight,
        seed=seed,
    )
    lower_bound = plain.lower_bound if max_told == 0 else people.lower_bound
    best = told if told is not None and told.objective < weighed.objective - _AS_GOOD else weighed
    return ToldPlan(
        outcome=Outcome.SOLVED,
        plan=best.plan,
        tellings=best.tellings,
        probabilities=best.probabilities,
        objective=best.objective,
        lower_bound=min(lower_bound, best.objective),
        objective_untold=weighed.objective,
        is_complete=is_complete,
    )


@dataclass(frozen=True, slots=True)
class _Weighed:
    plan: JointPlan
    tellings: tuple[Telling, ...]
    probabilities: tuple[float, ...]
    objective: float


class _People:
    """The person, as they are and as they would be after being told one set of differences or another."""

    def __init__(self, team_task: TeamTask, labeller: "Labeller", differences: Sequence[Difference]) -> None:
        self.team_task = team_task
        self.labeller = labeller
        self.differences = differences
        self.lower_bound = 0.0
        self.knowing: dict[frozenset[int], TeamFeatures] = {frozenset(): labeller.features(team_task)}

    def learn(self, max_told: int, deadline: float) -> bool:
        """Prepare sets of differences, the smallest first; return whether all up to a size were."""
        for size in range(1, min(max_told, len(self.differences)) + 1):
            for told in itertools.combinations(range(len(self.differences)), size):
                if len(self.knowing) >= _MOST_SETS or time.monotonic() > deadline:
                    return False
                corrected = tell(self.team_task, [self.differences[number] for number in told])
                self.knowing[frozenset(told)] = self.labeller.features(corrected)
        return True

    def plan(
        self,
        alpha: float,
        telling_cost: float,
        *,
        time_limit_s: float,
        human_model: "HumanModel | None",
        human_step_weight: float,
        seed: int,
    ) -> _Weighed | None:
        """Search for the best plan that may tell."""
        from explicable.labelling.knowing import telling_task, told_by

        compiled = telling_task(
            self.labeller,
            self.knowing,
            telling_cost,
            choice_model=human_model.model if human_model else None,
            charge=human_step_weight,
        )
        result = search(
            compiled.task,
            "anytime",
            scorer=compiled.scorer,
            alpha=alpha,
            time_limit_s=time_limit_s,
            seed=seed,
        )
        self.lower_bound = result.lower_bound
        if result.operators is None or result.objective is None:
            return None
        told: list[int] = []
        times: list[int] = []
        operators: list[int] = []
        for operator in result.operators:
            thing = told_by(compiled.task.action(operator))
            if thing is None:
                operators.append(operator)
            else:
                told.append(thing)
                times.append(len(operators))
        plan = _plan_of(self.team_task, operators)
        if human_step_weight == 0:  # else what people do hangs on it too
            self._wait(plan, told, times)
        tellings = tuple(
            Telling(before, self._teller(plan, before), self.differences[thing])
            for before, thing in zip(times, told, strict=True)
        )
        return _Weighed(plan, tellings, self._probabilities(plan, told, times), result.objective)

    def _probabilities(self, plan: JointPlan, told: Sequence[int], times: Sequence[int]) -> tuple[float, ...]:
        """Return how probably each step is expected, by one who is told some things before some steps."""
        watching = [
            self.knowing[
                frozenset(thing for thing, before in zip(told, times, strict=True) if before <= number)
            ]
            for number in range(len(plan))
        ]
        nobody = self.knowing[frozenset()]
        return self.labeller.label(nobody, plan.actions, knowing=watching).probabilities

    def _wait(self, plan: JointPlan, told: Sequence[int], times: list[int]) -> None:
        """Put each telling off for as long as that is as good."""
        most = sum(self._probabilities(plan, told, times))
        for place in reversed(range(len(told))):
            end = times[place + 1] if place + 1 < len(told) else len(plan) - 1
            for later in range(end, times[place], -1):
                put_off = [*times[:place], later, *times[place + 1 :]]
                if sum(self._probabilities(plan, told, put_off)) >= most - _AS_GOOD:
                    times[place] = later
                    break

    def _teller(self, plan: JointPlan, before_step: int) -> str:
        """Return the robot that acts next, or acted last."""
        robots = {agent.name for agent in self.team_task.problem.agents if agent.kind == "robot"}
        turns = (*plan.steps[before_step:], *reversed(plan.steps[:before_step]))
        return next((step.agent for step in turns if step.agent in robots), min(robots, default="robot"))


def _plan_of(team_task: TeamTask, operators: Sequence[int]) -> JointPlan:
    task = team_task.task
    return joint_plan(team_task, tuple(map(task.action, operators)), sum(map(task.cost, operators)))


def _candidates(
    team_task: TeamTask, labeller: "Labeller", plans: Sequence[JointPlan], max_told: int, time_limit_s: float
) -> list[Difference]:
    """Order what can be told: where not all can be tried, what explains the plans' steps comes first."""
    differences = find_differences(team_task.problem)
    num_sets = sum(math.comb(len(differences), size) for size in range(max_told + 1))
    if max_told == 0 or num_sets <= _MOST_SETS:
        return list(differences)
    explaining: dict[Difference, None] = {}
    for plan in plans:
        steps = explain(
            team_task, labeller, plan.actions, max_told=max_told, time_limit_s=time_limit_s / len(plans)
        )
        explaining.update(dict.fromkeys(difference for step in steps for difference in step.told))
    return [*explaining, *(difference for difference in differences if difference not in explaining)]

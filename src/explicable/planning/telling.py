"""Conform or explain: plan as the person expects, or tell them something on the way, whichever is cheaper.

Telling is a step of the plan with a cost of its own,

    J = cost + alpha * E[number of inexplicable steps] + telling_cost * number of differences told,

and each step is labelled under the mental model that the person has by then. Balancing the two in one
objective follows Chakraborti, Sreedharan & Kambhampati, "Balancing explicability and explanations in
human-aware planning" (IJCAI 2019), with the labeller in the place of optimality. What has been told is one
more variable of the task (`explicable.labelling.knowing`), so that one search settles what to do, what to
tell, and when.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict

from explicable.errors import UsageError
from explicable.model.plan import JointPlan, format_action
from explicable.model.team import TeamTask
from explicable.planning.deadline import Deadline
from explicable.planning.differences import Difference, find_differences
from explicable.planning.explanation import explain
from explicable.planning.listener import AS_GOOD, Listener, WeighedPlan
from explicable.planning.planner import plan_explicably
from explicable.planning.team_plan import DEFAULT_ALPHA, check_alpha, plan_of
from explicable.planning.tellings import Telling
from explicable.search import Outcome, search

if TYPE_CHECKING:
    from explicable.labelling import Labeller
    from explicable.labelling.features import TeamFeatures
    from explicable.planning.predictions import HumanModel


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
    alpha: float = DEFAULT_ALPHA,
    telling_cost: float = 1.0,
    max_told: int = 2,
    max_sets: int = 64,
    improve_s: float = 1.0,
    time_limit_s: float = 10.0,
    human_model: "HumanModel | None" = None,
    human_step_weight: float = 0.0,
    seed: int = 0,
) -> ToldPlan:
    """Find the cheapest of plans that conform to what the person expects, or that tell them something.

    The best explicable plan without telling comes first. What can be told are all differences between the two
    models; where their sets are too many, those come first that explain unexpected steps of that plan and of
    the cheapest one. A set is left out if its telling alone, with the least that any plan
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
    max_sets
        Most sets of differences that can have been told at some time, the empty one among them. A mental
        model is grounded for each, and the search goes over all, so that more of them may mean a worse plan
        in the same time. ``is_complete`` says whether some were left out.
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
    _check_telling(telling_cost, max_told, max_sets)
    deadline = Deadline.after(time_limit_s)
    features = labeller.features(team_task)
    options = _Options(alpha=alpha, human_model=human_model, human_step_weight=human_step_weight, seed=seed)
    plain = plan_explicably(features, labeller, improve_s=improve_s, time_limit_s=deadline.left_s, **options)
    if plain.plan is None or plain.labelled is None or plain.objective is None:
        return ToldPlan(plain.outcome, None, (), (), None, 0.0, None, is_complete=True)
    weighed = WeighedPlan(plain.plan, (), plain.labelled.probabilities, plain.objective)
    cheapest = search(team_task.task, "anytime", time_limit_s=min(improve_s, deadline.left_s), seed=seed)
    affordable = plain.objective - cheapest.lower_bound
    while max_told > 0 and telling_cost * max_told >= affordable:
        max_told -= 1
    told, is_complete, lower_bound = None, max_told == 0, 0.0
    if deadline.left_s > 0:
        plans = [
            plain.plan,
            *([] if cheapest.operators is None else [plan_of(team_task, cheapest.operators)]),
        ]
        listener, is_complete = _prepare(features, labeller, plans, max_told, max_sets, deadline)
        told = listener.plan(telling_cost, time_limit_s=min(improve_s, deadline.left_s), **options)
        lower_bound = listener.lower_bound
    best = told if told is not None and told.objective < weighed.objective - AS_GOOD else weighed
    return ToldPlan(
        outcome=Outcome.SOLVED,
        plan=best.plan,
        tellings=best.tellings,
        probabilities=best.probabilities,
        objective=best.objective,
        lower_bound=min(plain.lower_bound if max_told == 0 else lower_bound, best.objective),
        objective_untold=weighed.objective,
        is_complete=is_complete,
    )


class _Options(TypedDict):
    """What both plannings, without telling and with it, go by."""

    alpha: float
    human_model: "HumanModel | None"
    human_step_weight: float
    seed: int


def _check_telling(telling_cost: float, max_told: int, max_sets: int) -> None:
    if not math.isfinite(telling_cost) or telling_cost < 0 or max_told < 0:
        raise UsageError("the cost of telling must be finite, and neither it nor the size of a set negative")
    if max_sets < 1:
        raise UsageError("the person who is told nothing is one set: max_sets must be at least 1")


def _prepare(
    features: "TeamFeatures",
    labeller: "Labeller",
    plans: Sequence[JointPlan],
    max_told: int,
    max_sets: int,
    deadline: Deadline,
) -> tuple[Listener, bool]:
    """Prepare what can be told, in half the time at most; return whether that is all of it, too."""
    share_s = deadline.left_s / 2
    candidates = _candidates(features, labeller, plans, max_told, max_sets, share_s / 2)
    listener = Listener(features, labeller, candidates)
    return listener, listener.learn(max_told, max_sets, Deadline(deadline.moment_s - share_s))


def _candidates(
    features: "TeamFeatures",
    labeller: "Labeller",
    plans: Sequence[JointPlan],
    max_told: int,
    max_sets: int,
    time_limit_s: float,
) -> list[Difference]:
    """Order what can be told: where not all can be tried, what explains the plans' steps comes first."""
    differences = find_differences(features.team.problem)
    num_sets = sum(math.comb(len(differences), size) for size in range(max_told + 1))
    if max_told == 0 or num_sets <= max_sets:
        return list(differences)
    explaining: dict[Difference, None] = {}
    for plan in plans if time_limit_s > 0 else ():
        steps = explain(
            features, labeller, plan.actions, max_told=max_told, time_limit_s=time_limit_s / len(plans)
        )
        explaining.update(dict.fromkeys(difference for step in steps for difference in step.told))
    return [*explaining, *(difference for difference in differences if difference not in explaining)]

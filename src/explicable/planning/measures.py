"""All measures of a given plan, in one call."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.errors import PlanError, ResourceError
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamTask
from explicable.planning.beliefs import watch
from explicable.planning.deadline import Deadline
from explicable.planning.distances import PlanDistance, plan_distance
from explicable.planning.observer import CostToGo, Recognition, recognise, step_probabilities, surprise

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller
    from explicable.planning.predictions import HumanModel, PredictedSteps


@dataclass(frozen=True, slots=True)
class Measures:
    """What can be said of a plan. None where something was not asked for, or not found out in time.

    Attributes
    ----------
    cost
        In the composite task.
    reaches_goal
        Whether it does, in the composite task.
    labelled
        Steps with predicted labels, and F in all variants (method page, section 2).
    predicted
        How plausible the human steps are, ``f_human`` among it.
    distance
        To the nearest expected plan: the least of each distance over the expected plans.
    cost_gap
        ``C(plan) - C*`` in the mental model, where ``C*`` is the cost of the best plan there: what the plan
        costs too much in the person's eyes (Chakraborti, Sreedharan, Zhang & Kambhampati, "Plan explanations
        as model reconciliation", IJCAI 2017). Infinite if the plan is no plan there; None if nothing is.
    objection
        Why the plan is none in the mental model, or None.
    num_impossible
        How many steps the mental model does not allow at their turn.
    step_probabilities
        Of each robot's step, under a Boltzmann-rational observer; None for human steps.
    surprise
        ``-sum(log p)`` of these, in nats; infinite if one is 0.
    recognition
        Legibility and predictability of prefixes, where alternative goals were given.
    in_time
        False if exact costs-to-go in the mental model were not found out in time.
    """

    cost: int
    reaches_goal: bool
    labelled: "LabelledPlan | None"
    predicted: "PredictedSteps | None"
    distance: PlanDistance | None
    cost_gap: float | None
    objection: str | None
    num_impossible: int
    step_probabilities: tuple[float | None, ...] | None
    surprise: float | None
    recognition: Recognition | None
    in_time: bool


def measure(
    team_task: TeamTask,
    actions: Sequence[GroundAtom],
    labeller: "Labeller | None" = None,
    expected_plans: Iterable[Sequence[GroundAtom]] = (),
    *,
    human_model: "HumanModel | None" = None,
    alternative_goals: Sequence[Iterable[GroundAtom]] = (),
    temperature: float = 1.0,
    time_limit_s: float | None = None,
) -> Measures:
    """Measure a plan.

    Parameters
    ----------
    actions
        A plan of the composite task, from the initial state.
    labeller
        For F and labels.
    expected_plans
        Plans of the mental task; for distances.
    human_model
        Of the person's choices; for the plausibility of human steps.
    alternative_goals
        What else the robots could be after, in the person's eyes; for legibility and predictability.
    temperature
        Of the Boltzmann-rational observer, in the unit of cost.
    time_limit_s
        Seconds for all exact searches in the mental model.

    Raises
    ------
    PlanError
        If a plan can't be executed: the given one in the composite task, an expected one in the mental task.
    UsageError
        If the temperature is not finite and above 0, or an alternative goal is no conjunction of atoms of the
        human model.
    LabellerError
        If the labeller was trained on another domain.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.model.grounding import ground_team
    >>> team_task = ground_team(encode(World((".@*",))))
    >>> stray = [("move", "r1", "c-0-1", "c-0-0"), ("move", "r1", "c-0-0", "c-0-1")]
    >>> order = ("command", "person", "c-0-2")
    >>> rest = [order, ("move", "r1", "c-0-1", "c-0-2"), ("visit-room", "r1", "c-0-2")]
    >>> measures = measure(team_task, stray + rest, expected_plans=[rest])
    >>> measures.cost_gap, measures.distance.actions
    (2, 0.4)
    """
    execution = team_task.task.execute(actions)
    distances = [plan_distance(team_task, actions, plan) for plan in expected_plans]
    labelled = labeller.label(team_task, actions) if labeller else None
    mental_cost, objection = _in_mental_model(team_task, actions)

    deadline = Deadline.after(time_limit_s)
    cost_to_go = CostToGo(team_task.mental, deadline)
    least: float | None = None
    probabilities: tuple[float | None, ...] | None = None
    recognition: Recognition | None = None
    in_time = True
    try:
        least = cost_to_go(team_task.mental.initial_state)
        probabilities = step_probabilities(team_task, actions, temperature=temperature, cost_to_go=cost_to_go)
        if alternative_goals:
            recognition = recognise(
                team_task, actions, alternative_goals, temperature=temperature, deadline=deadline
            )
    except ResourceError:
        in_time = False
    return Measures(
        cost=execution.cost,
        reaches_goal=team_task.task.is_goal(execution.states[-1]),
        labelled=labelled,
        predicted=human_model.predict(team_task, actions) if human_model else None,
        distance=_least(distances),
        cost_gap=None if least is None or least == math.inf else mental_cost - least,
        objection=objection,
        num_impossible=watch(team_task, actions).num_impossible,
        step_probabilities=probabilities,
        surprise=None if probabilities is None else surprise(probabilities),
        recognition=recognition,
        in_time=in_time,
    )


def _in_mental_model(team_task: TeamTask, actions: Sequence[GroundAtom]) -> tuple[float, str | None]:
    """Return what a plan costs in the mental model; infinity, and why, if it is no plan there."""
    mental = team_task.mental
    try:
        execution = mental.execute(actions)
    except PlanError as error:
        return math.inf, error.message
    if not mental.is_goal(execution.states[-1]):
        return math.inf, "the plan does not reach the goal in the mental model"
    return execution.cost, None


def _least(distances: Sequence[PlanDistance]) -> PlanDistance | None:
    if not distances:
        return None
    return PlanDistance(
        actions=min(distance.actions for distance in distances),
        causal_links=min(distance.causal_links for distance in distances),
        states=min(distance.states for distance in distances),
    )

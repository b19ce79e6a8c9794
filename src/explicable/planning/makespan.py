"""Joint plans that end soon: planning for makespan.

A plan is made in several ways, each of which begins where a good schedule is likely to be found: without
regard to time, as the person expects, goal by goal (`explicable.planning.goal_orders`), and by beams over
sequences of steps (`explicable.planning.beams`), which can prove that no schedule ends sooner.
"""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.durations import Durations
from explicable.model.plan import Actions, Step
from explicable.model.schedule import Schedule, make_schedule
from explicable.model.team import TeamTask
from explicable.planning.beams import Beams
from explicable.planning.best_schedule import BestSchedule, schedule_objective
from explicable.planning.goal_orders import GoalOrders
from explicable.planning.planner import plan_explicably
from explicable.planning.relaxed_times import RelaxedTimes, Timetable
from explicable.planning.team_plan import DEFAULT_ALPHA, check_alpha
from explicable.planning.tellings import Telling, label_told
from explicable.search import Outcome, search

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller

_SHARE_OF_EXPLICABLE, _SHARE_OF_ORDERS = 0.2, 0.4
"""Parts of the time for the explicable planner, and for plans made goal by goal; the beams have the rest."""


@dataclass(frozen=True, slots=True)
class ScheduledPlan:
    """What planning for makespan came to.

    Parameters
    ----------
    outcome
        Solved if there is a schedule; else proved unsolvable, limit reached or interrupted.
    schedule
        The best schedule found.
    labelled
        Its steps in the order of their start times, with predicted labels, if a labeller was given.
    objective
        ``makespan + alpha * E[number of inexplicable steps]``.
    lower_bound
        No schedule has a lower makespan.
    num_nodes
        Nodes whose bound was computed.
    search_s
        Seconds spent.
    """

    outcome: Outcome
    schedule: Schedule | None
    labelled: "LabelledPlan | None"
    objective: float | None
    lower_bound: float
    num_nodes: int
    search_s: float

    @property
    def probabilities(self) -> tuple[float | None, ...]:
        """Of each step of the schedule, that it is expected; None without labels, and of a telling."""
        known = iter(self.labelled.probabilities if self.labelled else ())
        steps = self.schedule.steps if self.schedule else ()
        return tuple(None if step.listeners else next(known, None) for step in steps)

    @property
    def is_optimal(self) -> bool:
        """Whether no schedule has a lower makespan."""
        return self.schedule is not None and self.schedule.makespan <= self.lower_bound + 1e-9


def plan_schedule(
    team_task: TeamTask,
    durations: Durations | None = None,
    *,
    labeller: "Labeller | None" = None,
    alpha: float = DEFAULT_ALPHA,
    time_limit_s: float = 10.0,
    max_width: int = 4096,
    seed: int = 0,
) -> ScheduledPlan:
    """Plan for ``makespan + alpha * E[number of inexplicable steps]``; without a labeller, for makespan.

    The search looks for low makespans; of all the plans that it meets, the one of least objective is taken.
    The first is that of the sequential search, so there is an answer as soon as that has one; then come that
    of the explicable planner, plans made goal by goal (`explicable.planning.goal_orders`), and the beams.

    Parameters
    ----------
    durations
        Of the steps; by default 1 each.
    alpha
        Price of one inexplicable step, in the unit of the durations.
    time_limit_s
        Seconds for everything.
    max_width
        Widest beam.

    Raises
    ------
    UsageError
        If alpha is negative or not finite, or there is no time or no beam.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground_team
    >>> plan_schedule(ground_team(encode(World(("@.*", "@.*"))))).schedule.makespan
    3.0
    """
    check_alpha(alpha)
    if not (time_limit_s > 0 and max_width > 0):
        raise UsageError("time_limit_s and max_width must be above 0")
    began = time.perf_counter()
    result = search(team_task.task, seed=seed, time_limit_s=time_limit_s)
    if result.operators is None:
        bound = math.inf if result.outcome is Outcome.UNSOLVABLE else 0.0
        return ScheduledPlan(result.outcome, None, None, None, bound, 0, time.perf_counter() - began)
    best = BestSchedule(team_task, durations or Durations(), labeller, alpha)
    best.consider(tuple(map(team_task.task.action, result.operators)))
    if labeller is not None:
        share_s = _SHARE_OF_EXPLICABLE * time_limit_s
        expected = plan_explicably(
            best.features or team_task,
            labeller,
            alpha=alpha,
            time_limit_s=share_s,
            improve_s=share_s,
            seed=seed,
        )
        if expected.plan is not None:
            best.consider(expected.plan.actions)
    beams = Beams(team_task, best, began + time_limit_s)
    orders_end = time.perf_counter() + _SHARE_OF_ORDERS * time_limit_s
    orders = GoalOrders(team_task, best.durations, lambda: time.perf_counter() > orders_end)
    try:
        for actions in orders.plans():
            best.consider(actions)
        lower_bound = beams.run(max_width)
    except KeyboardInterrupt:
        lower_bound = beams.lower_bound
    return ScheduledPlan(
        Outcome.SOLVED,
        best.schedule,
        best.labelled,
        best.objective,
        lower_bound,
        beams.num_nodes,
        time.perf_counter() - began,
    )


def schedule_plan(
    team_task: TeamTask,
    actions: Actions,
    durations: Durations | None = None,
    *,
    labeller: "Labeller | None" = None,
    alpha: float = DEFAULT_ALPHA,
    tellings: Sequence[Telling] = (),
) -> ScheduledPlan:
    """Let the steps of a given plan overlap where they don't interfere.

    Its steps and its partial order stay; the lower bound is that of any plan, from the relaxation. A telling
    takes as long as the durations say of the action ``tell``. It occupies the robot that tells and all
    people, and what the plan does after it starts after it; each step is labelled as by people who know what
    has been told by its start.

    Parameters
    ----------
    actions
        A sequence that the composite task allows; it need not reach the goal.
    durations, alpha
        As in `plan_schedule`.
    tellings
        What the person is told, in order; see `part_tellings`.

    Raises
    ------
    PlanError
        At the first step that is not applicable.
    UsageError
        If alpha is negative or not finite.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground_team
    >>> plan = [
    ...     ("command", "person", "c-0-1"),
    ...     ("move", "r1", "c-0-0", "c-0-1"),
    ...     ("visit-room", "r1", "c-0-1"),
    ... ]
    >>> schedule_plan(ground_team(encode(World(("@*",)))), tuple(plan)).schedule.makespan
    2.0
    """
    began = time.perf_counter()
    durations = durations or Durations()
    steps = [(telling.before_step, Step(telling.agent, telling.action)) for telling in tellings]
    schedule = make_schedule(team_task.problem, team_task.task, actions, durations, tellings=steps)
    labelled = _labelled(team_task, labeller, schedule, tellings) if labeller else None
    timetable = Timetable(team_task, durations)
    bound = float(RelaxedTimes(timetable).rate([timetable.root()])[0][0])
    objective = schedule_objective(schedule, labelled, check_alpha(alpha))
    return ScheduledPlan(Outcome.SOLVED, schedule, labelled, objective, bound, 1, time.perf_counter() - began)


def _labelled(
    team_task: TeamTask, labeller: "Labeller", schedule: Schedule, tellings: Sequence[Telling]
) -> "LabelledPlan":
    """Label a schedule's actions in the order of their starts, each by what was told by then."""
    told = {telling.action: telling.difference for telling in tellings}
    ends = [(step.end, told[step.step.action]) for step in schedule.steps if step.listeners]
    known = [
        frozenset(difference for end, difference in ends if end <= step.start)
        for step in schedule.steps
        if not step.listeners
    ]
    return label_told(team_task, labeller, schedule.actions, known)

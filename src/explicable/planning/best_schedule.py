"""The best schedule so far, of plans made in whatever way."""

import math
from typing import TYPE_CHECKING

from explicable.model.durations import Durations
from explicable.model.plan import Actions
from explicable.model.schedule import Schedule, make_schedule
from explicable.model.team import TeamTask
from explicable.planning.beliefs import applicable_operator

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller


class BestSchedule:
    """The best of the plans that were considered, as a schedule; see `explicable.planning.makespan`."""

    def __init__(
        self, team_task: TeamTask, durations: Durations, labeller: "Labeller | None", alpha: float
    ) -> None:
        self.team_task, self.durations, self.labeller, self.alpha = team_task, durations, labeller, alpha
        self.features = labeller.features(team_task) if labeller else None
        self.schedule: Schedule | None = None
        self.labelled: LabelledPlan | None = None
        self.objective = self.least_makespan = math.inf
        self.num_steps = 0

    def consider(self, actions: Actions) -> None:
        """Take a plan if it is better, or as good and shorter, once superfluous steps are gone."""
        schedule = self._lean(self._schedule(actions))
        self.least_makespan = min(self.least_makespan, schedule.makespan)
        labelled = None
        if self.labeller and self.features:
            labelled = self.labeller.label(self.features, schedule.actions)
        objective = schedule_objective(schedule, labelled, self.alpha)
        if (objective, len(schedule.steps)) < (self.objective, self.num_steps):
            self.schedule, self.labelled = schedule, labelled
            self.objective, self.num_steps = objective, len(schedule.steps)

    def _schedule(self, actions: Actions) -> Schedule:
        return make_schedule(self.team_task.problem, self.team_task.task, actions, self.durations)

    def _lean(self, schedule: Schedule) -> Schedule:
        """Drop steps that nothing needs (Nakhost & Mueller, "Action elimination", ICAPS 2010)."""
        number = 0
        while number < len(schedule.steps):
            rest = self._without(schedule.actions, number)
            shorter = None if rest is None else self._schedule(rest)
            if shorter is not None and shorter.makespan <= schedule.makespan:
                schedule = shorter
            else:
                number += 1
        return schedule

    def _without(self, actions: Actions, number: int) -> Actions | None:
        """Return a plan without one step and those that then are impossible, if it still reaches the goal."""
        task = self.team_task.task
        state, kept = task.execute(actions[:number]).states[-1], list(actions[:number])
        for action in actions[number + 1 :]:
            operator = applicable_operator(task, state, action)
            if operator is not None:
                state = task.successor(state, operator)
                kept.append(action)
        return tuple(kept) if task.is_goal(state) else None


def schedule_objective(schedule: Schedule, labelled: "LabelledPlan | None", alpha: float) -> float:
    """Return ``makespan + alpha * E[number of inexplicable steps]``."""
    if labelled is None or labelled.scores.f_expected is None:
        return schedule.makespan
    return schedule.makespan + alpha * len(schedule.actions) * (1.0 - labelled.scores.f_expected)

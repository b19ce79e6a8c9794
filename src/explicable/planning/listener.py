"""One search over what to do, what to tell and when: the person as they are, and as they would be once told.

For each set of differences that can have been told by some time there is a mental model, grounded and
compiled (`explicable.labelling.knowing`); what has been told is one more variable of the task.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.model.plan import JointPlan
from explicable.model.task import Task
from explicable.planning.deadline import Deadline
from explicable.planning.differences import Difference
from explicable.planning.explanation import tell
from explicable.planning.team_plan import plan_of
from explicable.planning.tellings import Telling
from explicable.search import search

if TYPE_CHECKING:
    from explicable.labelling import Labeller
    from explicable.labelling.features import TeamFeatures
    from explicable.planning.predictions import HumanModel

AS_GOOD = 1e-9
"""Differences in J that are but rounding."""


@dataclass(frozen=True, slots=True)
class WeighedPlan:
    """A plan, what is told in it, how probably each step is then expected, and J."""

    plan: JointPlan
    tellings: tuple[Telling, ...]
    probabilities: tuple[float, ...]
    objective: float


class Listener:
    """The person, as they are and as they would be after being told one set of differences or another."""

    def __init__(
        self, features: "TeamFeatures", labeller: "Labeller", differences: Sequence[Difference]
    ) -> None:
        self.team_task = features.team
        self.labeller = labeller
        self.differences = differences
        self.lower_bound = 0.0
        self.knowing: dict[frozenset[int], TeamFeatures] = {frozenset(): features}

    def learn(self, max_told: int, max_sets: int, deadline: Deadline) -> bool:
        """Prepare sets of differences, the smallest first; return whether all up to a size were."""
        for size in range(1, min(max_told, len(self.differences)) + 1):
            for told in itertools.combinations(range(len(self.differences)), size):
                if len(self.knowing) >= max_sets or deadline.left_s <= 0:
                    return False
                corrected = tell(self.team_task, [self.differences[number] for number in told])
                self.knowing[frozenset(told)] = self.labeller.features(corrected)
        return True

    def plan(
        self,
        telling_cost: float,
        *,
        alpha: float,
        time_limit_s: float,
        human_model: "HumanModel | None",
        human_step_weight: float,
        seed: int,
    ) -> WeighedPlan | None:
        """Search for the best plan that may tell."""
        from explicable.labelling.knowing import telling_task

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
        operators, told, times = _part_tellings(compiled.task, result.operators)
        plan = plan_of(self.team_task, operators)
        if human_step_weight == 0:  # else what people do hangs on it too
            times = self._put_off(plan, told, times)
        tellings = tuple(
            Telling(before, self._teller(plan, before), self.differences[thing])
            for before, thing in zip(times, told, strict=True)
        )
        return WeighedPlan(plan, tellings, self._probabilities(plan, told, times), result.objective)

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

    def _put_off(self, plan: JointPlan, told: Sequence[int], times: Sequence[int]) -> list[int]:
        """Return before which step each thing can be told at the latest and be worth as much."""
        most = sum(self._probabilities(plan, told, times))
        times = list(times)
        for place in reversed(range(len(told))):
            end = times[place + 1] if place + 1 < len(told) else len(plan) - 1
            for later in range(end, times[place], -1):
                put_off = [*times[:place], later, *times[place + 1 :]]
                if sum(self._probabilities(plan, told, put_off)) >= most - AS_GOOD:
                    times[place] = later
                    break
        return times

    def _teller(self, plan: JointPlan, before_step: int) -> str:
        """Return the robot that acts next, or acted last."""
        robots = {agent.name for agent in self.team_task.problem.agents if agent.kind == "robot"}
        turns = (*plan.steps[before_step:], *reversed(plan.steps[:before_step]))
        return next((step.agent for step in turns if step.agent in robots), min(robots, default="robot"))


def _part_tellings(task: Task, operators: Sequence[int]) -> tuple[list[int], list[int], list[int]]:
    """Return the steps of a compiled plan, what is told in it, and before which step each thing is."""
    from explicable.labelling.knowing import told_by

    steps: list[int] = []
    told: list[int] = []
    times: list[int] = []
    for operator in operators:
        thing = told_by(task.action(operator))
        if thing is None:
            steps.append(operator)
        else:
            told.append(thing)
            times.append(len(steps))
    return steps, told, times

"""Where search meets labelling: planning with regard to what the person expects.

=========  ==========================================================================================
plans      `team_plan` (Eq. 3), `planner` (Eq. 4), `exploration` of the `pareto` front, `budgets`, `ranking`
telling    `telling` searches with the `listener`; `tellings` in plans and plan files
schedules  `makespan` with `relaxed_times` and `gantt`: steps that overlap
measures   `measures` calls `distances`, `observer` (with `beliefs`) and `predictions` of what people do
why        `explanation` by `differences` of the two models, told by `correction`; `schemas` for both
=========  ==========================================================================================

The public names are imported when they are first asked for: a plan needs only the planner.
"""

from typing import TYPE_CHECKING

from explicable.lazy import lazy_names

if TYPE_CHECKING:
    from explicable.planning.affordable import plan_most_explicably
    from explicable.planning.budgets import choose, plan_within_budget
    from explicable.planning.correction import correct
    from explicable.planning.differences import Comparison, Difference, compare, find_differences
    from explicable.planning.explanation import Finding, StepExplanation, explain
    from explicable.planning.exploration import front
    from explicable.planning.makespan import ScheduledPlan, plan_schedule, schedule_plan
    from explicable.planning.measures import Measures, measure
    from explicable.planning.pareto import FrontPlan
    from explicable.planning.planner import plan_as_in_paper, plan_classically, plan_explicably
    from explicable.planning.predictions import HumanModel, PredictedSteps
    from explicable.planning.ranking import RankedPlan, rank
    from explicable.planning.team_plan import TeamPlan, check_alpha, joint_plan, objective
    from explicable.planning.telling import ToldPlan, conform_or_explain
    from explicable.planning.tellings import Telling, part_tellings

_HOMES = {
    "Comparison": "differences",
    "Difference": "differences",
    "Finding": "explanation",
    "FrontPlan": "pareto",
    "HumanModel": "predictions",
    "Measures": "measures",
    "PredictedSteps": "predictions",
    "RankedPlan": "ranking",
    "ScheduledPlan": "makespan",
    "StepExplanation": "explanation",
    "TeamPlan": "team_plan",
    "Telling": "tellings",
    "ToldPlan": "telling",
    "check_alpha": "team_plan",
    "choose": "budgets",
    "compare": "differences",
    "conform_or_explain": "telling",
    "correct": "correction",
    "explain": "explanation",
    "find_differences": "differences",
    "front": "exploration",
    "joint_plan": "team_plan",
    "measure": "measures",
    "objective": "team_plan",
    "part_tellings": "tellings",
    "plan_as_in_paper": "planner",
    "plan_classically": "planner",
    "plan_explicably": "planner",
    "plan_schedule": "makespan",
    "plan_most_explicably": "affordable",
    "plan_within_budget": "budgets",
    "rank": "ranking",
    "schedule_plan": "makespan",
}

__all__ = [
    "Comparison",
    "Difference",
    "Finding",
    "FrontPlan",
    "HumanModel",
    "Measures",
    "PredictedSteps",
    "RankedPlan",
    "ScheduledPlan",
    "StepExplanation",
    "TeamPlan",
    "Telling",
    "ToldPlan",
    "check_alpha",
    "choose",
    "compare",
    "conform_or_explain",
    "correct",
    "explain",
    "find_differences",
    "front",
    "joint_plan",
    "measure",
    "objective",
    "part_tellings",
    "plan_as_in_paper",
    "plan_classically",
    "plan_explicably",
    "plan_most_explicably",
    "plan_schedule",
    "plan_within_budget",
    "rank",
    "schedule_plan",
]


__getattr__, __dir__ = lazy_names(__name__, _HOMES)

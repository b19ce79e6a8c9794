"""Where search meets labelling: planning with regard to what the person expects.

The public names, each imported when it is first asked for: a plan needs only the planner.
"""

from typing import TYPE_CHECKING

from explicable.lazy import lazy_names

if TYPE_CHECKING:
    from explicable.planning.correction import correct
    from explicable.planning.differences import Comparison, Difference, compare, find_differences
    from explicable.planning.explanation import Finding, StepExplanation, explain
    from explicable.planning.makespan import ScheduledPlan, plan_schedule, schedule_plan
    from explicable.planning.measures import Measures, measure
    from explicable.planning.pareto import FrontPlan, choose, front, plan_within_budget
    from explicable.planning.planner import (
        TeamPlan,
        check_alpha,
        joint_plan,
        objective,
        plan_as_in_paper,
        plan_classically,
        plan_explicably,
    )
    from explicable.planning.predictions import HumanModel, PredictedSteps
    from explicable.planning.ranking import RankedPlan, rank
    from explicable.planning.telling import ToldPlan, conform_or_explain

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
    "TeamPlan": "planner",
    "ToldPlan": "telling",
    "check_alpha": "planner",
    "choose": "pareto",
    "compare": "differences",
    "conform_or_explain": "telling",
    "correct": "correction",
    "explain": "explanation",
    "find_differences": "differences",
    "front": "pareto",
    "joint_plan": "planner",
    "measure": "measures",
    "objective": "planner",
    "plan_as_in_paper": "planner",
    "plan_classically": "planner",
    "plan_explicably": "planner",
    "plan_schedule": "makespan",
    "plan_within_budget": "pareto",
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
    "plan_as_in_paper",
    "plan_classically",
    "plan_explicably",
    "plan_schedule",
    "plan_within_budget",
    "rank",
    "schedule_plan",
]


__getattr__, __dir__ = lazy_names(__name__, _HOMES)

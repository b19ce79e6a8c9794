"""Where search meets labelling: planning with regard to what the person expects.

The public names, each imported when it is first asked for: a plan needs only the planner.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from explicable.planning.differences import Difference, correct, find_differences
    from explicable.planning.explanation import Finding, StepExplanation, explain
    from explicable.planning.measures import Measures, measure
    from explicable.planning.pareto import FrontPlan, choose, front
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
    "Difference": "differences",
    "Finding": "explanation",
    "FrontPlan": "pareto",
    "HumanModel": "predictions",
    "Measures": "measures",
    "PredictedSteps": "predictions",
    "RankedPlan": "ranking",
    "StepExplanation": "explanation",
    "TeamPlan": "planner",
    "ToldPlan": "telling",
    "check_alpha": "planner",
    "choose": "pareto",
    "conform_or_explain": "telling",
    "correct": "differences",
    "explain": "explanation",
    "find_differences": "differences",
    "front": "pareto",
    "joint_plan": "planner",
    "measure": "measures",
    "objective": "planner",
    "plan_as_in_paper": "planner",
    "plan_classically": "planner",
    "plan_explicably": "planner",
    "rank": "ranking",
}

__all__ = [
    "Difference",
    "Finding",
    "FrontPlan",
    "HumanModel",
    "Measures",
    "PredictedSteps",
    "RankedPlan",
    "StepExplanation",
    "TeamPlan",
    "ToldPlan",
    "check_alpha",
    "choose",
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
    "rank",
]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'explicable.planning' has no attribute {name!r}")
    return getattr(import_module(f"explicable.planning.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return __all__

"""Where search meets labelling: planning with regard to what the person expects."""

from explicable.planning.differences import Difference, correct, find_differences
from explicable.planning.explanation import Finding, StepExplanation, explain
from explicable.planning.front import FrontPlan, choose, front
from explicable.planning.measures import Measures, measure
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

"""Where search meets labelling: planning with regard to what the person expects."""

from explicable.planning.measures import Measures, measure
from explicable.planning.planner import (
    TeamPlan,
    check_alpha,
    joint_plan,
    objective,
    plan_classically,
    plan_explicably,
)
from explicable.planning.rank import RankedPlan, rank

__all__ = [
    "Measures",
    "RankedPlan",
    "TeamPlan",
    "check_alpha",
    "joint_plan",
    "measure",
    "objective",
    "plan_classically",
    "plan_explicably",
    "rank",
]

"""Where search meets labelling: planning with regard to what the person expects."""

from explicable.planning.planner import (
    TeamPlan,
    check_alpha,
    joint_plan,
    objective,
    plan_classically,
    plan_explicably,
)

__all__ = ["TeamPlan", "check_alpha", "joint_plan", "objective", "plan_classically", "plan_explicably"]

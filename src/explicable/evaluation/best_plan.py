"""The explicable plan of an experiment: of the least J, the same whatever the machine's speed and load."""

import math

from explicable.labelling import Labeller
from explicable.model.team import TeamTask
from explicable.planning import HumanModel, TeamPlan, plan_explicably
from explicable.planning.team_plan import DEFAULT_ALPHA

PROOF_EVALUATIONS = 200_000
"""Budget of a search for the least objective: more than any proof on the maps takes, some seconds elsewhere.

Not in seconds, so that records do not hang on the machine's speed and load.
"""


def plan_best(
    team_task: TeamTask,
    labeller: Labeller,
    *,
    alpha: float = DEFAULT_ALPHA,
    human_model: HumanModel | None = None,
    human_step_weight: float = 0.0,
) -> TeamPlan:
    """Plan explicably as by default, but up to the proof, or as far as `PROOF_EVALUATIONS` go."""
    return plan_explicably(
        team_task,
        labeller,
        alpha=alpha,
        improve_s=math.inf,
        max_evaluations=PROOF_EVALUATIONS,
        human_model=human_model,
        human_step_weight=human_step_weight,
    )

"""The most explicable of the plans that cost no more than so much, wherever these lie among all plans.

With a price ``alpha`` in the place of a limit only the corners of the front can be found (`front`): a plan
between two of them is best at no price, however good a use it makes of the cost that is allowed. So the limit
goes into the search itself (an epsilon constraint: Haimes, Lasdon & Wismer, "On a bicriterion formulation",
IEEE Trans. SMC 1, 1971). What lies on no plan within the limit is cut off, and of two paths to a context one
makes the other superfluous only if it costs no more, too.
"""

from typing import TYPE_CHECKING

from explicable.planning.planner import plan_explicably
from explicable.planning.team_plan import TeamPlan

if TYPE_CHECKING:
    from explicable.labelling import Labeller
    from explicable.labelling.features import TeamFeatures
    from explicable.model.team import TeamTask

DECISIVE = 1e4
"""Stands for an infinite alpha: of plans with as many inexplicable steps the cheapest is taken, and what
explains less than this part of a step is not worth one unit of cost."""


def plan_most_explicably(
    team_task: "TeamTask | TeamFeatures",
    labeller: "Labeller",
    max_cost: int | None = None,
    *,
    improve_s: float = 1.0,
    time_limit_s: float | None = None,
    max_evaluations: int | None = None,
    seed: int = 0,
) -> TeamPlan:
    """Find the plan of fewest inexplicable steps, by expectation, among those of at most `max_cost`.

    Parameters
    ----------
    team_task
        As in `plan_explicably`.
    max_cost
        None: whatever it costs.
    improve_s, time_limit_s, max_evaluations
        As in `plan_explicably`.

    Returns
    -------
    TeamPlan
        Its objective is reckoned by the alpha `DECISIVE`; if that is also the lower bound, no plan within the
        limit is more explicable. Without a plan where none was found that keeps to the limit.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.labelling.crf import ConditionalRandomField
    >>> from explicable.labelling.labeller import Labeller
    >>> from explicable.model.grounding import ground_team
    >>> names, weights = ["step: remove-obstacle", "step: move"], [[-5.0, 0.0], [3.0, 0.0]]
    >>> model = ConditionalRandomField.from_weights([True, False], names, weights, [[0, 0], [0, 0]])
    >>> labeller = Labeller(model, schemas=["move"])
    >>> team_task = ground_team(encode(World(("@o*", "..."))))
    >>> [plan_most_explicably(team_task, labeller, limit).plan.cost for limit in (4, None)]
    [4, 6]
    """
    return plan_explicably(
        team_task,
        labeller,
        alpha=DECISIVE,
        max_cost=max_cost,
        improve_s=improve_s,
        time_limit_s=time_limit_s,
        max_evaluations=max_evaluations,
        seed=seed,
    )

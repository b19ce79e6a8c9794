"""The search for the front of cost and explicability (`explicable.planning.pareto`): corners, then between.

``J`` is linear in cost and explicability, so its least plans over all alpha are the corners of the lower
convex hull of all plans. They are found corner by corner: the alpha at which two neighbours have the same
``J`` either shows a plan that is better than both there, or that there is none between them (Aneja & Nair,
"Bicriteria transportation problem", Management Science 25, 1979). Between two corners lie plans that are best
at no alpha, and still no other is both as cheap and as explicable: they are found by searches for the most
explicable plan of at most so much cost (the second of the two phases of Ulungu & Teghem, "The two phases
method", Found. Computing and Decision Sci. 20, 1995).
"""

from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.team import TeamTask
from explicable.planning.affordable import plan_most_explicably
from explicable.planning.deadline import Deadline
from explicable.planning.pareto import Front, Pool
from explicable.planning.planner import plan_classically, plan_explicably
from explicable.planning.team_plan import check_alpha
from explicable.search import Outcome, held_interrupt

if TYPE_CHECKING:
    from explicable.labelling import Labeller

SMALLEST_ALPHA = 1e-4
"""Stands for 0: so that of all cheapest plans the most explicable is taken."""


def front(
    team_task: TeamTask,
    labeller: "Labeller",
    *,
    max_alpha: float = 10.0,
    search_s: float = 1.0,
    time_limit_s: float | None = None,
    seed: int = 0,
) -> Front:
    """Find all plans that have the least ``J`` for some alpha from 0 to `max_alpha`, and those between them.

    Parameters
    ----------
    max_alpha
        The largest price of an inexplicable step to look at, in the unit of cost.
    search_s
        Seconds for each of the searches, of which there are one or two a plan.
    time_limit_s
        Seconds for all of them; what is found by then is given.

    Returns
    -------
    tuple of FrontPlan
        The cheapest first: costs rise and expected numbers of inexplicable steps fall; empty if none was
        found. After Ctrl-C what was found by then.

    Raises
    ------
    UsageError
        If `max_alpha` is not finite, or below `SMALLEST_ALPHA`.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.labelling.crf import ConditionalRandomField
    >>> from explicable.labelling.labeller import Labeller
    >>> from explicable.model.grounding import ground_team
    >>> weights = ["step: move"], [[-5.0, 0.0]], [[0, 0], [0, 0]]
    >>> labeller = Labeller(ConditionalRandomField.from_weights([True, False], *weights), schemas=["move"])
    >>> [(found.plan.cost, found.alpha_to) for found in front(ground_team(encode(World((".@*",)))), labeller)]
    [(3, inf)]
    """
    pool = explore(team_task, labeller, max_alpha, search_s, time_limit_s, seed)
    if pool.outcome is Outcome.INTERRUPTED and not pool.has_plan:
        raise KeyboardInterrupt
    return pool.front()


@held_interrupt()
def explore(
    team_task: TeamTask,
    labeller: "Labeller",
    max_alpha: float,
    search_s: float,
    time_limit_s: float | None,
    seed: int,
) -> Pool:
    """Look for plans at the alphas at which the front may have another corner; parameters as of `front`.

    Raises
    ------
    UsageError
        If the largest alpha is no price, or too small to look at.
    """
    if check_alpha(max_alpha) < SMALLEST_ALPHA:
        raise UsageError(f"the largest alpha must be at least {SMALLEST_ALPHA}, not {max_alpha}")
    deadline = Deadline.after(time_limit_s)
    features = labeller.features(team_task)
    pool = Pool()

    def solve(alpha: float) -> None:
        found = plan_explicably(
            features, labeller, alpha=alpha, improve_s=search_s, time_limit_s=deadline.limit_s, seed=seed
        )
        pool.add(found, alpha)

    cheapest_s = min(search_s, deadline.left_s)
    pool.add(
        plan_classically(
            team_task, labeller=labeller, algorithm="anytime", time_limit_s=cheapest_s, seed=seed
        )
    )
    alphas = [SMALLEST_ALPHA, max_alpha]
    while alphas and pool.outcome is not Outcome.INTERRUPTED and (deadline.left_s > 0 or not pool.has_plan):
        solve(alphas[0])
        alphas = alphas[1:] if alphas[0] == SMALLEST_ALPHA else pool.unsettled(max_alpha)
    while (
        (max_cost := pool.next_limit()) is not None
        and pool.outcome is not Outcome.INTERRUPTED
        and deadline.left_s > 0
    ):
        found = plan_most_explicably(
            features, labeller, max_cost, improve_s=search_s, time_limit_s=deadline.limit_s, seed=seed
        )
        pool.add_within(max_cost, found)
    return pool

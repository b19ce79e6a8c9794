"""The explicable planner: the joint plan that is cheap *and* expected.

The paper's objective is `explicable.planning.team_plan.objective` (Eq. 3). Its heuristic (Eq. 4), for a path
to a state and a relaxed plan ``rp`` from there, is

    h = (1 - F(L(path # rp))) * |path # rp| * |rp| + |rp|  =  (1 + c) * |rp|

where ``c`` is the number of inexplicable steps in ``path # rp``.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypedDict

from explicable.errors import UsageError
from explicable.model.team import TeamTask
from explicable.planning.team_plan import DEFAULT_ALPHA, TeamPlan, best_plan, check_alpha
from explicable.search import (
    Algorithm,
    Closing,
    Outcome,
    PathScorer,
    SearchResult,
    held_interrupt,
    search,
)

if TYPE_CHECKING:  # planning without a labeller starts without NumPy
    from explicable.labelling import Labeller
    from explicable.labelling.features import TeamFeatures
    from explicable.planning.predictions import HumanModel


def plan_classically(
    team_task: TeamTask,
    *,
    labeller: "Labeller | None" = None,
    algorithm: Algorithm = "default",
    time_limit_s: float | None = None,
    memory_limit_bytes: int | None = None,
    max_evaluations: int | None = None,
    seed: int = 0,
) -> TeamPlan:
    """Plan without regard to what the person expects; a labeller only scores the plan.

    Parameters
    ----------
    algorithm
        A search of `explicable.search.search`: ``"ff"`` is FF as published.
    time_limit_s, memory_limit_bytes, max_evaluations
        As in `explicable.search.search`.
    """
    result = search(
        team_task.task,
        algorithm,
        time_limit_s=time_limit_s,
        memory_limit_bytes=memory_limit_bytes,
        max_evaluations=max_evaluations,
        seed=seed,
    )
    return best_plan(team_task, [result], labeller)


@held_interrupt()  # between the searches, too, Ctrl-C leaves the best plan so far
def plan_explicably(
    team_task: "TeamTask | TeamFeatures",
    labeller: "Labeller",
    *,
    alpha: float = DEFAULT_ALPHA,
    algorithm: Algorithm = "default",
    expected: bool = True,
    closing: Closing = "state",
    time_limit_s: float | None = None,
    memory_limit_bytes: int | None = None,
    max_evaluations: int | None = None,
    improve_s: float = 1.0,
    gap: float = 0.0,
    max_cost: int | None = None,
    human_model: "HumanModel | None" = None,
    human_step_weight: float = 0.0,
    seed: int = 0,
    on_better: Callable[[float], None] | None = None,
) -> TeamPlan:
    """Plan steps that the person will find sensible: by Eq. 4, then improving ``J`` (Eq. 3).

    At goal states the heuristic of Eq. 4 is zero, whatever was inexplicable on the way: it steers the search
    but does not choose the plan. Hence the second part, which begins with the better of that plan and one
    made without regard to the person, and goes on for a better ``J``, until the least is proved or the time
    is up: ``lower_bound`` says which.

    Parameters
    ----------
    team_task
        The task, or what the labeller sees of it if that was made before (`Labeller.features`).
    alpha
        Price of one inexplicable step, in the unit of cost.
    algorithm
        Of the search for the first plan: ``"lazy"`` or ``"eager"`` best-first search by ``f = g + h``;
        ``"default"``: lazy, with look-ahead where the task is large; ``"ff"``: enforced hill-climbing first,
        as in the paper.
    expected
        Count inexplicable steps by their expectation; False: by the most probable labels, as in the paper.
    closing
        Of the search for the first plan. ``"state"``: a state is closed alone, as in the paper.
        ``"context"``: together with what the labeller still needs to know of the path, which is exact for
        ``f``, but there are many more such nodes.
    time_limit_s, max_evaluations
        Seconds, and heuristic values, for the whole search.
    memory_limit_bytes
        As in `explicable.search.search`, of which there are up to two, one after the other.
    improve_s
        Seconds for the improvement of the first plan at most; 0 for the paper's planner, which has none.
    gap
        The improvement ends once no plan can have a ``J`` that is lower by more than this share.
    max_cost
        Dearer plans are left out; the first plan is the cheapest then, and not that of Eq. 4, which knows no
        limit of cost. Without a plan, "limit reached" says that none of at most this cost was found.
    human_model, human_step_weight
        What people choose, and what a plan is charged, in the unit of cost, for each nat of surprise at what
        it makes the person do: ``J`` gains ``human_step_weight * -log P(the person's part | the robots')``,
        so that a plan can't look good by giving the person convenient orders (method page, section 2).
    on_better
        Called with ``J`` of each plan of the improvement that is better than all before.

    Raises
    ------
    UsageError
        If a price is negative, infinite or not a number, or human steps are to be charged without a model.
    """
    if human_step_weight != 0 and human_model is None:
        raise UsageError("human steps can be charged for only with a model of what people choose")
    features = labeller.features(team_task)
    team_task = features.team
    choice_model = human_model.model if human_model else None
    scorer = labeller.scorer(features, expected=expected, choice_model=choice_model, charge=human_step_weight)
    options = _Options(
        scorer=scorer,
        seed=seed,
        alpha=check_alpha(alpha),
        memory_limit_bytes=memory_limit_bytes,
        max_evaluations=max_evaluations,
    )
    if max_cost is None:
        first = search(team_task.task, algorithm, closing=closing, time_limit_s=time_limit_s, **options)
    else:
        limit_s = improve_s if time_limit_s is None else min(improve_s, time_limit_s)
        first = _cheapest(team_task, max_cost, limit_s, options)
    results = [first]
    left_s = improve_s if time_limit_s is None else min(improve_s, time_limit_s - first.search_s)
    if first.outcome is Outcome.SOLVED and left_s > 0:
        if not expected:  # J is by expectation, whatever led to the first plan
            options["scorer"] = labeller.scorer(features, choice_model=choice_model, charge=human_step_weight)
        results = _improve(team_task, first, left_s, options, max_cost, gap, on_better)
    charged = (human_model, human_step_weight) if human_model else None
    return best_plan(team_task, results, labeller, alpha, charged, features)


def plan_as_in_paper(
    team_task: TeamTask,
    labeller: "Labeller",
    *,
    time_limit_s: float | None = None,
    memory_limit_bytes: int | None = None,
    max_evaluations: int | None = None,
    seed: int = 0,
) -> TeamPlan:
    """Plan with the paper's own settings.

    Eq. 4 in enforced hill-climbing and then in best-first search, steps counted by their most probable
    labels, states closed alone, and the first plan is the answer.

    Parameters
    ----------
    time_limit_s, memory_limit_bytes, max_evaluations
        As in `explicable.search.search`.
    seed
        Breaks ties.
    """
    return plan_explicably(
        team_task,
        labeller,
        algorithm="ff",
        expected=False,
        closing="state",
        time_limit_s=time_limit_s,
        memory_limit_bytes=memory_limit_bytes,
        max_evaluations=max_evaluations,
        improve_s=0,
        seed=seed,
    )


def _improve(
    team_task: TeamTask,
    first: SearchResult,
    left_s: float,
    options: "_Options",
    max_cost: int | None,
    gap: float,
    on_better: Callable[[float], None] | None,
) -> list[SearchResult]:
    """Return the first result, and those of the searches for a better ``J``."""
    results = [first]
    if max_cost is None:  # else the first plan is the cheapest already
        results.append(_careless(team_task, left_s * _SHARE_OF_CARELESS, _left(options, results)))
    left_s -= sum(result.search_s for result in results[1:])
    left = _left(options, results)
    if left_s > 0 and left["max_evaluations"] != 0 and results[-1].outcome is not Outcome.INTERRUPTED:
        known_plans = [result.operators for result in results if result.operators is not None]
        results.append(
            search(
                team_task.task,
                "anytime",
                known_plans=known_plans,
                max_cost=max_cost,
                time_limit_s=left_s,
                gap=gap,
                on_better=on_better,
                **left,
            )
        )
    return results


def _careless(team_task: TeamTask, limit_s: float, options: "_Options") -> SearchResult:
    """Search for a plan without regard to the person: what is improved should be no worse than that."""
    found = search(
        team_task.task,
        seed=options["seed"],
        memory_limit_bytes=options["memory_limit_bytes"],
        max_evaluations=options["max_evaluations"],
        time_limit_s=limit_s,
    )
    return replace(found, is_optimal=False, lower_bound=0.0)  # of J nothing is known


def _left(options: "_Options", before: Sequence[SearchResult]) -> "_Options":
    """Return the options with as many evaluations as some searches have left."""
    if options["max_evaluations"] is None:
        return options
    spent = sum(result.evaluations for result in before)
    return {**options, "max_evaluations": max(options["max_evaluations"] - spent, 0)}


def _cheapest(team_task: TeamTask, max_cost: int, limit_s: float, options: "_Options") -> SearchResult:
    """Search for the cheapest plan; a dearer one than is allowed counts as none."""
    found = search(
        team_task.task,
        "anytime",
        seed=options["seed"],
        memory_limit_bytes=options["memory_limit_bytes"],
        max_evaluations=options["max_evaluations"],
        time_limit_s=limit_s,
    )
    if found.cost is None or found.cost <= max_cost:
        return replace(found, is_optimal=False)  # of the cost alone
    return replace(found, outcome=Outcome.LIMIT, operators=None, cost=None, objective=None)


_SHARE_OF_CARELESS = 0.25
"""Of the time for the improvement: at most so much for a plan without regard to the person."""


class _Options(TypedDict):
    scorer: PathScorer
    seed: int
    alpha: float
    memory_limit_bytes: int | None
    max_evaluations: int | None

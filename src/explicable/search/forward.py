"""One function for all forward searches."""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Literal

from explicable import _core
from explicable.errors import UsageError
from explicable.model.problem import GroundAtom
from explicable.model.task import State, Task
from explicable.search.interruption import held_interrupt
from explicable.search.result import Outcome, SearchResult

Algorithm = Literal["default", "ff", "lazy", "eager", "bfws", "astar", "wastar", "anytime"]
Heuristic = Literal["ff", "lmcut", "hmax", "blind", "tour"]
Preferred = Literal["relaxed plan", "helpful", "none"]
Closing = Literal["state", "context"]
Distance = Literal["count", "ratio"]


def search(
    task: Task,
    algorithm: Algorithm = "default",
    *,
    initial_state: State | None = None,
    goal: Iterable[int | GroundAtom] | None = None,
    heuristic: Heuristic | None = None,
    preferred: Preferred | None = None,
    lookahead: bool = False,
    weight: float = 5.0,
    seed: int = 0,
    time_limit_s: float | None = None,
    memory_limit_bytes: int | None = None,
    max_evaluations: int | None = None,
    scorer: _core.PathScorer | None = None,
    closing: Closing = "state",
    alpha: float = 0.0,
    distance: Distance = "count",
    max_cost: int | None = None,
    known_plans: Sequence[Sequence[int]] = (),
    gap: float = 0.0,
    on_better: Callable[[float], None] | None = None,
) -> SearchResult:
    """Search for a plan.

    Parameters
    ----------
    task
        The grounded task.
    algorithm
        ``"default"``
            Lazy greedy search with look-ahead [6]_, without it, and best-first width search, in turns with
            growing budgets; then the plan is shortened [7]_. With a scorer, lazy greedy search with a budget,
            then with look-ahead.
        ``"ff"``
            Enforced hill-climbing over helpful actions, then best-first search [1]_.
        ``"lazy"``, ``"eager"``
            Greedy best-first search by the FF heuristic, with a second queue for preferred operators [2]_.
        ``"bfws"``
            Best-first width search BFWS(f5): novelty, then the number of open goals [3]_.
        ``"astar"``
            A* with an admissible heuristic; its plans are optimal. LM-cut [4]_ by default.
        ``"wastar"``
            A* with ``weight`` on the heuristic.
        ``"anytime"``
            A first plan by ``"default"``, then restarting weighted A* [5]_ in turns with A*, until the best
            plan is proved optimal or a limit is reached. With a scorer: the plan of least cost + alpha * dist
            (Eq. 3), by A* with lower bounds of what lies ahead, made by sweeps over all contexts where these
            are few enough (some 100 000).
    initial_state, goal
        Where to start and what to reach, if not what the task says; the goal as facts or atoms. With an atom
        that is never true it is *unsolvable*.
    heuristic
        For ``"astar"`` (``"lmcut"``, ``"hmax"``, ``"blind"``, ``"tour"``) and ``"wastar"`` (``"ff"`` as
        well). The tour goes through all places where one variable, such as a robot's position, has to be for
        the goal; where there are none, it is LM-cut.
    preferred
        Which operators the second queue holds: all helpful actions (default of ``"lazy"``), those that are in
        the relaxed plan, or none (default of ``"eager"``).
    lookahead
        Of ``"lazy"``: whether to look first at the state that a relaxed plan leads to when its operators are
        executed for as long as they can be [6]_.
    weight
        Of the heuristic in ``"wastar"``, at least 1.
    seed
        0: ties go by the order of generation. Any other seed shuffles them; the same seed, the same result.
    time_limit_s, memory_limit_bytes, max_evaluations
        Wall-clock seconds; bytes held by nodes, open lists and what the search prepares, by default three
        fifths of what the machine and its control group had left at the task's first search (containers that
        grow take up to a third more for moments); heuristic values computed.
    scorer
        With a compiled path scorer, ``"default"``, ``"ff"``, ``"lazy"`` and ``"eager"`` search by
        h = (1 + c) * length(rp) (Eq. 4), where c counts the inexplicable steps in path # rp; best-first
        search orders by f = g + h.
    closing
        Of best-first search with a scorer: two nodes are the same when they agree in the state, or also in
        what the features of later steps see of the path; of such, one is dropped only if, whatever follows,
        it has no fewer inexplicable steps at no lower cost. ``"anytime"`` closes nodes in its own way.
    alpha, distance
        Of ``"anytime"`` with a scorer: dist is the number of inexplicable steps or their share.
    max_cost
        Of ``"anytime"`` with a scorer: dearer plans are not considered; the bound and the proof are of those
        that are left. A cheap plan should be known then, since the search for a first one heeds no costs.
    known_plans
        Of ``"anytime"``: plans, as operators; the best is begun with instead of a search for a first one.
    gap
        Of ``"anytime"`` with a scorer: enough is proved once no plan can be better by more than this share of
        the objective. 0: until the best plan is proved.
    on_better
        Of ``"anytime"`` with a scorer: called with the objective of each plan better than all before.

    Returns
    -------
    SearchResult
        *Unsolvable*, *out of time* and *interrupted* are results. Ctrl-C ends the search, not the process.

    Raises
    ------
    UsageError
        If an option has no meaning, there is no fact of a number in the goal, or the scorer or state belongs
        to another task.

    References
    ----------
    .. [1] Hoffmann & Nebel, "The FF planning system", JAIR 14, 2001.
    .. [2] Richter & Helmert, "Preferred operators and deferred evaluation in satisficing planning", ICAPS
       2009; Richter & Westphal, "The LAMA planner", JAIR 39, 2010.
    .. [3] Lipovetzky & Geffner, "Best-first width search", AAAI 2017.
    .. [4] Helmert & Domshlak, "Landmarks, critical paths and abstractions", ICAPS 2009.
    .. [5] Richter, Thayer & Ruml, "The joy of forgetting", ICAPS 2010.
    .. [6] Vidal, "A lookahead strategy for heuristic search planning", ICAPS 2004.
    .. [7] Nakhost & Mueller, "Action elimination and plan neighborhood graph search", ICAPS 2010.

    Examples
    --------
    >>> from explicable.model.grounding import ground
    >>> from explicable.model.problem import ActionSchema, And, Atom, Domain, Effect, Predicate, Problem
    >>> lamp = Atom("on", ())
    >>> switch = ActionSchema("switch", (), And(), (Effect(lamp),))
    >>> domain = Domain("room", frozenset(), {}, {}, (Predicate("on", ()),), (), (switch,))
    >>> task = ground(Problem("dark", domain, {}, (), lamp, {}))
    >>> result = search(task)
    >>> result.outcome.value, [task.action(operator) for operator in result.operators]
    ('solved', [('switch',)])
    """
    _check(algorithm, weight, seed, time_limit_s, memory_limit_bytes, max_evaluations, scorer, alpha, gap)
    goal_facts, goal_reachable = _goal_facts(task, goal)
    if not goal_reachable:
        return _UNREACHABLE
    if memory_limit_bytes is None:
        memory_limit_bytes = task.search_memory_bytes
    whole_plans = [_whole(task, plan, initial_state, goal_facts) for plan in known_plans]
    try:
        with held_interrupt() as interrupt:
            answer = _core.search(
                task.core,
                initial_state,
                goal_facts,
                algorithm=algorithm,
                heuristic=heuristic or "",
                preferred=preferred or ("none" if algorithm == "eager" else "helpful"),
                lookahead=lookahead,
                weight=weight,
                seed=seed,
                scorer=scorer,
                closing=closing,
                alpha=alpha,
                ratio=distance == "ratio",
                max_cost=max_cost,
                known_plans=whole_plans,
                gap=gap,
                on_better=on_better,
                interrupted=interrupt.is_pending,
                time_limit_s=math.inf if time_limit_s is None else time_limit_s,
                memory_limit_bytes=memory_limit_bytes,
                max_evaluations=max_evaluations,
            )
    except MemoryError:  # even before the search began
        return SearchResult(Outcome.LIMIT, None, None, None, 0.0, False, 0, 0, 0, 0.0, "memory")
    except (ValueError, IndexError) as error:
        raise UsageError(str(error)) from error
    return _result(task, answer, was_interrupted=interrupt.is_pending())


_LIMITS = ("time", "memory", "evaluations")
_LABELLED = ("default", "ff", "lazy", "eager", "anytime")
_UNREACHABLE = SearchResult(Outcome.UNSOLVABLE, None, None, None, math.inf, False, 0, 0, 0, 0.0, None)


def _result(task: Task, answer: _core.SearchAnswer, *, was_interrupted: bool) -> SearchResult:
    plan = answer.plan
    return SearchResult(
        outcome=Outcome.INTERRUPTED if was_interrupted else Outcome(answer.outcome),
        # What stands for a disjunctive goal is no step of the plan.
        operators=None if plan is None else tuple(filter(task.action, plan)),
        cost=None if plan is None else answer.cost,
        objective=None if plan is None else answer.objective,
        lower_bound=answer.lower_bound,
        is_optimal=answer.is_optimal,
        evaluations=answer.evaluations,
        expansions=answer.expansions,
        memory_bytes=answer.memory_bytes,
        search_s=answer.search_s,
        limit=answer.stop if answer.stop in _LIMITS else None,
    )


def _goal_facts(task: Task, goal: Iterable[int | GroundAtom] | None) -> tuple[list[int], bool]:
    if goal is None:
        return list(task.goal), task.goal_reachable
    parts = list(goal)
    facts = {part for part in parts if isinstance(part, int)}
    if len(facts) == len(parts):
        return sorted(facts), True
    other = task.with_goal(part for part in parts if not isinstance(part, int))
    return sorted(facts.union(other.goal)), other.goal_reachable


def _whole(task: Task, plan: Sequence[int], initial_state: State | None, goal: Sequence[int]) -> list[int]:
    """Complete a plan by the auxiliary operator that ends it, if one has to."""
    whole = list(plan)
    state = task.initial_state if initial_state is None else initial_state
    for operator in whole:
        if not 0 <= operator < task.num_operators or not task.is_applicable(state, operator):
            raise UsageError("what was given as a known plan is none")
        state = task.successor(state, operator)
    if not task.core.holds(state, goal):
        whole += [o for o in task.applicable(state) if not task.action(o) and task.core.adds(o) == list(goal)]
    return whole


def _check(
    algorithm: str,
    weight: float,
    seed: int,
    time_limit_s: float | None,
    memory_limit_bytes: int | None,
    max_evaluations: int | None,
    scorer: _core.PathScorer | None,
    alpha: float,
    gap: float,
) -> None:
    if scorer is not None and algorithm not in _LABELLED:
        raise UsageError(f"{algorithm} search knows no labelled version; use one of {', '.join(_LABELLED)}")
    if not 1.0 <= weight < math.inf:
        raise UsageError(f"the weight of the heuristic must be at least 1 and finite, not {weight}")
    if not 0 <= seed < 2**64:
        raise UsageError(f"the seed must be from 0 to 2**64 - 1, not {seed}")
    if time_limit_s is not None and not time_limit_s >= 0.0:
        raise UsageError(f"the time limit must not be negative: {time_limit_s}")
    for name, value in (("memory limit", memory_limit_bytes), ("number of evaluations", max_evaluations)):
        if value is not None and not 0 <= value < 2**63:
            raise UsageError(f"the {name} is out of range: {value}")
    if not 0.0 <= alpha < math.inf:
        raise UsageError(f"alpha must be finite and not negative, not {alpha}")
    if not 0.0 <= gap < 1.0:
        raise UsageError(f"the gap is a share from 0 to below 1, not {gap}")

"""A Boltzmann-rational observer of the mental task: surprise, legibility and predictability of a plan.

The observer expects an agent to choose actions by what they cost in the end,

    Q(s, a) = cost(a) + V(a(s)),    p(a | s) ~ exp(-Q(s, a) / T),

where V is the exact cost-to-go in the mental model and T the temperature, in the unit of cost: near 0 for an
observer who expects the best and nothing else, large for one who expects anything. Baker, Saxe & Tenenbaum,
"Action understanding as inverse planning" (Cognition 113, 2009).
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from explicable.errors import ResourceError, UsageError
from explicable.model.problem import GroundAtom, Problem
from explicable.model.task import State, Task
from explicable.model.team import TeamTask
from explicable.planning.beliefs import watch
from explicable.planning.deadline import NEVER, Deadline
from explicable.search import Outcome, search


class CostToGo:
    """Exact costs-to-go of one task, each found by A* once; every search answers for all states on its way.

    Parameters
    ----------
    task
        The task; its own goal counts.
    deadline
        After which no more is searched.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.model.grounding import ground
    >>> task = ground(encode(World(("@.*",))).robot)
    >>> CostToGo(task)(task.initial_state)
    4
    """

    def __init__(self, task: Task, deadline: Deadline = NEVER) -> None:
        self.task = task
        self.deadline = deadline
        self._known: dict[State, float] = {}

    def __call__(self, state: State) -> float:
        """Return what the cheapest plan from a state costs; infinite if there is none.

        Raises
        ------
        ResourceError
            If that is not found out in time, or in the memory there is.
        """
        if state not in self._known:
            limit_s = self.deadline.limit_s
            result = search(self.task, "astar", initial_state=state, time_limit_s=limit_s)
            if result.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            if limit_s == 0 or result.outcome is Outcome.LIMIT:
                raise ResourceError("the exact cost-to-go in the mental model was not found out in time")
            self._remember(state, result.operators, result.cost)
        return self._known[state]

    def _remember(self, state: State, operators: Sequence[int] | None, cost: int | None) -> None:
        if operators is None or cost is None:
            self._known[state] = math.inf
            return
        self._known[state] = cost
        for operator in operators:
            cost -= self.task.cost(operator)
            state = self.task.successor(state, operator)
            self._known[state] = cost


def step_probabilities(
    team_task: TeamTask,
    actions: Sequence[GroundAtom],
    *,
    temperature: float = 1.0,
    cost_to_go: CostToGo | None = None,
) -> tuple[float | None, ...]:
    """Return how probable each robot's step was for the observer.

    The alternatives of a step are all that its agent could do then, as the person believes: whose turn it is
    is no surprise. Beliefs go on as in `explicable.planning.beliefs.watch`.

    Parameters
    ----------
    temperature
        Of the observer, in the unit of cost.
    cost_to_go
        Of the mental task; what it remembers is used again.

    Returns
    -------
    tuple of float or None
        None for human steps; 0 for a step that the mental model does not allow, or after which it sees no way
        to the goal while there were others. If no alternative leads to the goal, all are alike.

    Raises
    ------
    PlanError
        If the composite task does not allow a step.
    UsageError
        If the temperature is not finite and above 0.
    ResourceError
        If costs-to-go are not found out in time.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.model.grounding import ground_team
    >>> team_task = ground_team(encode(World((".@*",))))
    >>> (p,) = step_probabilities(team_task, [("move", "r1", "c-0-1", "c-0-0")])
    >>> round(p, 3)  # away instead of towards: 2 steps more
    0.119
    """
    _check_temperature(temperature)
    mental, agent_of = team_task.mental, team_task.problem.agent_of
    value = cost_to_go or CostToGo(mental)
    watched = watch(team_task, actions)
    found: list[float | None] = []
    for action, taken, state in zip(actions, watched.operators, watched.states, strict=False):
        agent = agent_of(action)
        if agent.kind == "human":
            found.append(None)
        elif taken is None:
            found.append(0.0)
        else:
            options = [
                option
                for option in mental.applicable(state)
                if (does := mental.action(option)) and agent_of(does) == agent
            ]
            costs = [mental.cost(option) + value(mental.successor(state, option)) for option in options]
            found.append(_softmin(costs, temperature)[options.index(taken)])
    return tuple(found)


def surprise(probabilities: Iterable[float | None]) -> float:
    """Return ``-sum(log p)`` in nats over the robots' steps; infinite if one was held to be impossible.

    Examples
    --------
    >>> round(surprise([0.5, None, 0.5]), 3), surprise([0.0])
    (1.386, inf)
    """
    return sum((-math.log(p) if p > 0 else math.inf for p in probabilities if p is not None), start=0.0)


@dataclass(frozen=True, slots=True)
class Recognition:
    """What an observer makes of a plan's prefixes, where it could have several goals.

    Attributes
    ----------
    goal_probabilities
        For each prefix, from none to all steps, the probability of each goal; the plan's own goal first.
    legibility
        How soon the own goal can be told from the others, from 0 to 1.
    predictability
        For each prefix, how near it keeps to the best way to the own goal, from 0 to 1.
    """

    goal_probabilities: tuple[tuple[float, ...], ...]
    legibility: float
    predictability: tuple[float, ...]


def recognise(
    team_task: TeamTask,
    actions: Sequence[GroundAtom],
    alternative_goals: Sequence[Iterable[GroundAtom]],
    *,
    temperature: float = 1.0,
    deadline: Deadline = NEVER,
) -> Recognition:
    """Measure legibility and predictability of a plan's prefixes.

    With S the initial state, Q the state after the first t of N steps, both in the mental model, C the cost
    of those steps there, and T the temperature (Dragan, Lee & Srinivasa, "Legibility and predictability of
    robot motion", HRI 2013; here in costs above the least, all goals equally likely at first):

    - ``p(G | prefix) ~ exp(-(C + V_G(Q) - V_G(S)) / T)``,
    - legibility ``= sum_t f(t) p(G* | prefix) / sum_t f(t)``, t = 1 .. N, with ``f(t) = N + 1 - t``: early
      steps count most,
    - predictability of a prefix ``= exp(-(C + V_G*(Q) - V_G*(S)) / T)``: 1 if a best plan begins like this.

    Where no goal can be reached any more, all are equally likely. A plan without steps has the legibility of
    the prior.

    Parameters
    ----------
    alternative_goals
        Besides the mental task's own: each a conjunction of atoms of the human model.

    Raises
    ------
    PlanError, ResourceError
        As `step_probabilities`.
    UsageError
        As there, or if a goal names an atom that the human model does not know.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.model.grounding import ground_team
    >>> team_task = ground_team(encode(World((".@*",))))
    >>> way = [("move", "r1", "c-0-1", "c-0-2")]
    >>> seen = recognise(team_task, way, [[("at", "r1", "c-0-0")]])
    >>> [round(p, 2) for p, _ in seen.goal_probabilities], seen.predictability
    ([0.5, 0.88], (1.0, 1.0))
    """
    _check_temperature(temperature)
    mental = team_task.mental
    alternative_goals = [tuple(goal) for goal in alternative_goals]
    for goal in alternative_goals:
        _check_sayable(mental.problem, goal)
    goals = [mental, *(mental.with_goal(goal) for goal in alternative_goals)]
    values = [CostToGo(task, deadline) for task in goals]
    watched = watch(team_task, actions)
    at_start = [value(mental.initial_state) for value in values]
    spent, detours = 0, []
    for cost, state in zip((0, *watched.costs), watched.states, strict=True):
        spent += cost
        detours.append(
            [_detour(spent, value(state), least) for value, least in zip(values, at_start, strict=True)]
        )
    posteriors = [tuple(_softmin(row, temperature)) for row in detours]
    num_steps = len(actions)
    weights = [num_steps + 1 - t for t in range(1, num_steps + 1)]
    told = sum(w * p[0] for w, p in zip(weights, posteriors[1:], strict=True))
    return Recognition(
        goal_probabilities=tuple(posteriors),
        legibility=told / sum(weights) if weights else posteriors[0][0],
        predictability=tuple(math.exp(min(0.0, -row[0] / temperature)) for row in detours),
    )


def _check_temperature(temperature: float) -> None:
    if not 0 < temperature < math.inf:
        raise UsageError(f"the temperature must be finite and above 0, not {temperature}")


def _check_sayable(problem: Problem, goal: Iterable[GroundAtom]) -> None:
    arities = {predicate.name: len(predicate.parameters) for predicate in problem.domain.predicates}
    objects = {*problem.objects, *problem.domain.constants}
    for atom in goal:
        if arities.get(atom[0]) != len(atom) - 1 or not objects.issuperset(atom[1:]):
            raise UsageError(f"an alternative goal: ({' '.join(atom)}) is no atom of the human model")


def _detour(spent: float, to_go: float, least: float) -> float:
    return math.inf if math.inf in {to_go, least} else spent + to_go - least


def _softmin(costs: Sequence[float], temperature: float) -> list[float]:
    """Return probabilities proportional to exp(-cost / temperature); all alike if every cost is infinite."""
    least = min(costs)
    if least == math.inf:
        return [1 / len(costs)] * len(costs)
    weights = [math.exp((least - cost) / temperature) for cost in costs]
    total = sum(weights)
    return [weight / total for weight in weights]

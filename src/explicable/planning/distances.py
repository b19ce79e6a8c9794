"""How far a plan is from one that the person expects: three distances, each from 0 (same) to 1.

Srivastava, Nguyen, Gerevini, Kambhampati, Do & Serina, "Domain independent approaches for finding diverse
plans" (IJCAI 2007); with the mental model's plans in the place of a second plan: Kulkarni, Zha, Chakraborti,
Vadlamudi, Zhang & Kambhampati, "Explicable planning as minimizing distance from expected behavior"
(AAMAS 2019).
"""

from collections.abc import Sequence, Set
from dataclasses import dataclass

from explicable.model.problem import GroundAtom
from explicable.model.task import Execution, State, Task
from explicable.model.team import TeamTask

INIT: GroundAtom = ("initial state",)
GOAL: GroundAtom = ("goal",)

CausalLink = tuple[GroundAtom, GroundAtom, GroundAtom]


@dataclass(frozen=True, slots=True)
class PlanDistance:
    """Distances between a plan and an expected one.

    Attributes
    ----------
    actions
        ``1 - |A & B| / |A | B|`` of the sets of actions.
    causal_links
        The same of the sets of causal links (producer, fact, consumer).
    states
        ``(sum_k d(s_k, t_k) + n - m) / n`` over the states s after each of n steps and t after each of m <= n
        steps, where d is ``1 - |s & t| / |s | t|``.
    """

    actions: float
    causal_links: float
    states: float


def plan_distance(
    team_task: TeamTask, actions: Sequence[GroundAtom], expected: Sequence[GroundAtom]
) -> PlanDistance:
    """Measure how far a plan is from one that the person expects.

    The plan is executed in the composite task, the expected one in the mental task. Of their states and
    causal links only facts count that both tasks have: what the person has no word for, or what never changes
    in one of the models, makes no distance.

    Raises
    ------
    PlanError
        If the plan can't be executed in the composite task, or the expected one in the mental task.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.model.grounding import ground_team
    >>> team_task = ground_team(encode(World(("@.*",))))
    >>> way = [("move", "r1", "c-0-0", "c-0-1"), ("move", "r1", "c-0-1", "c-0-2")]
    >>> plan_distance(team_task, way, way[:1])
    PlanDistance(actions=0.5, causal_links=0.5, states=0.5)
    """
    task, mental = team_task.task, team_task.mental
    own, theirs = task.execute(actions), mental.execute(expected)
    shared = frozenset(
        fact for number in range(task.num_facts) if mental.fact_number(fact := task.fact(number)) is not None
    )
    own_states = [task.atoms(state) & shared for state in own.states[1:]]
    their_states = [mental.atoms(state) & shared for state in theirs.states[1:]]
    return PlanDistance(
        actions=_set_distance(set(actions), set(expected)),
        causal_links=_set_distance(_links(task, own, shared), _links(mental, theirs, shared)),
        states=_sequence_distance(own_states, their_states),
    )


def _links(task: Task, execution: Execution, shared: Set[GroundAtom]) -> set[CausalLink]:
    return {link for link in causal_links(task, execution) if link[1] in shared}


def causal_links(task: Task, execution: Execution) -> set[CausalLink]:
    """List who made true what a step, or the goal, needs.

    Returns
    -------
    set of (producer, fact, consumer)
        The producer is the last action that made the fact true, `INIT` if none did; the consumer an action,
        or `GOAL` for a goal that holds at the end.
    """
    consumers = [
        (task.action(operator), task.core.preconditions(operator)) for operator in execution.operators
    ]
    held = [fact for fact in task.goal if _holds(task, execution.states[-1], fact)]
    links: set[CausalLink] = set()
    for number, (consumer, needs) in enumerate([*consumers, (GOAL, held)]):
        for fact in needs:
            producer = next(
                (k for k in reversed(range(number)) if not _holds(task, execution.states[k], fact)), None
            )
            made = INIT if producer is None else task.action(execution.operators[producer])
            links.add((made, task.fact(fact), consumer))
    return links


def _holds(task: Task, state: State, fact: int) -> bool:
    return task.core.holds(state, [fact])


def _set_distance(one: Set[object], other: Set[object]) -> float:
    either = len(one | other)
    return 1 - len(one & other) / either if either else 0.0


def _sequence_distance(one: Sequence[Set[object]], other: Sequence[Set[object]]) -> float:
    longest = max(len(one), len(other))
    if longest == 0:
        return 0.0
    common = sum(1 - _set_distance(s, t) for s, t in zip(one, other, strict=False))
    return 1 - common / longest

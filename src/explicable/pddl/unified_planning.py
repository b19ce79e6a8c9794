"""The way to and from the library unified-planning, which takes and gives our problems, actions and plans."""

from fractions import Fraction
from typing import TYPE_CHECKING

from explicable.errors import PlanError
from explicable.model.durations import Durations
from explicable.model.problem import GroundAtom, Problem
from explicable.model.schedule import Schedule
from explicable.pddl.writer import format_domain, format_problem

if TYPE_CHECKING:
    from unified_planning.model import Problem as PeerProblem
    from unified_planning.plans import ActionInstance, PartialOrderPlan, Plan, TimeTriggeredPlan


def to_peer_problem(problem: Problem) -> "PeerProblem":
    """Hand a problem over, by way of PDDL.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> sorted(action.name for action in to_peer_problem(encode(World(("@.*",))).composite).actions)
    ['command', 'move', 'remove-obstacle', 'visit-room']
    """
    from unified_planning.io import PDDLReader

    # In the library's common environment: its simulator does not work in others (1.3.0).
    reader = PDDLReader()
    return reader.parse_problem_string(format_domain(problem.domain), format_problem(problem))


def to_peer_action(problem: "PeerProblem", action: GroundAtom) -> "ActionInstance":
    """Hand an action over.

    Raises
    ------
    PlanError
        If the problem has no such action or object.
    """
    from unified_planning.exceptions import UPValueError
    from unified_planning.plans import ActionInstance

    try:
        schema = problem.action(action[0])
        expressions = problem.environment.expression_manager
        arguments = [expressions.ObjectExp(problem.object(name)) for name in action[1:]]
    except UPValueError as error:
        raise PlanError(f"({' '.join(action)}) is not in the problem ({error})") from error
    if len(arguments) != len(schema.parameters):
        raise PlanError(f"({' '.join(action)}) should have {len(schema.parameters)} arguments")
    return ActionInstance(schema, tuple(arguments))


def from_peer_plan(plan: "Plan") -> tuple[GroundAtom, ...]:
    """Take a plan over as a sequence of actions.

    Of a partial-order plan, one of its orders; of a time-triggered plan, the actions by their start times.

    Raises
    ------
    PlanError
        If it is a plan of another kind.
    """
    from unified_planning.plans import PartialOrderPlan, SequentialPlan, TimeTriggeredPlan

    if isinstance(plan, SequentialPlan):
        instances = plan.actions
    elif isinstance(plan, PartialOrderPlan):
        instances = next(iter(plan.all_sequential_plans())).actions
    elif isinstance(plan, TimeTriggeredPlan):
        instances = [instance for _, instance, _ in sorted(plan.timed_actions, key=lambda timed: timed[0])]
    else:
        raise PlanError(f"a {type(plan).__name__} is no sequence of actions")
    return tuple(_from_peer_action(instance) for instance in instances)


def _from_peer_action(instance: "ActionInstance") -> GroundAtom:
    return (instance.action.name, *(str(argument) for argument in instance.actual_parameters))


def to_peer_temporal_problem(problem: Problem, durations: Durations) -> "PeerProblem":
    """Hand a problem over with durative actions.

    What an action needs must hold from its start up to its end, where its effects come true. Where the
    durations of single actions differ, their schema has the interval.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> problem = to_peer_temporal_problem(encode(World(("@.*",))).composite, Durations(default=2.0))
    >>> str(problem.action("move").duration)
    '[2, 2]'
    """
    from unified_planning.model import DurativeAction, EndTiming, RightOpenTimeInterval, StartTiming

    peer = to_peer_problem(problem)
    instantaneous = list(peer.actions)
    peer.clear_actions()
    for action in instantaneous:
        own = [value for name, value in durations.actions.items() if name[0] == action.name]
        lengths = [durations.schemas.get(action.name, durations.default), *own]
        durative = DurativeAction(action.name, {p.name: p.type for p in action.parameters})
        durative.set_closed_duration_interval(Fraction(min(lengths)), Fraction(max(lengths)))
        for condition in action.preconditions:
            durative.add_condition(RightOpenTimeInterval(StartTiming(), EndTiming()), condition)
        for effect in action.effects:
            durative._add_effect_instance(EndTiming(), effect)
        peer.add_action(durative)
    peer.clear_quality_metrics()
    return peer


def to_peer_partial_order(schedule: Schedule, problem: "PeerProblem") -> "PartialOrderPlan":
    """Hand a schedule over as a partial-order plan, without its times."""
    from unified_planning.plans import PartialOrderPlan

    instances = [to_peer_action(problem, scheduled.step.action) for scheduled in schedule.steps]
    followers: dict[ActionInstance, list[ActionInstance]] = {instance: [] for instance in instances}
    for instance, scheduled in zip(instances, schedule.steps, strict=True):
        for before in scheduled.after:
            followers[instances[before]].append(instance)
    return PartialOrderPlan(followers, problem.environment)


def to_peer_time_triggered(
    schedule: Schedule, problem: "PeerProblem", separation: Fraction = Fraction(1, 1000)
) -> "TimeTriggeredPlan":
    """Hand a schedule over as a time-triggered plan, for a problem of `to_peer_temporal_problem`.

    Parameters
    ----------
    separation
        PDDL 2.1 wants a little time between an effect and the next step that needs it: so much for each step
        before another on a chain, in the unit of the durations.
    """
    from unified_planning.plans import TimeTriggeredPlan

    depths: list[int] = []
    timed = []
    for scheduled in schedule.steps:
        depths.append(max((depths[before] + 1 for before in scheduled.after), default=0))
        start = Fraction(scheduled.start) + depths[-1] * separation
        action = to_peer_action(problem, scheduled.step.action)
        timed.append((start, action, Fraction(scheduled.duration)))
    return TimeTriggeredPlan(timed, problem.environment)

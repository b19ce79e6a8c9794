"""The way to and from the library unified-planning, which takes and gives our problems, actions and plans."""

from typing import TYPE_CHECKING

from explicable.errors import PlanError
from explicable.model.problem import GroundAtom, Problem
from explicable.pddl.writer import format_domain, format_problem

if TYPE_CHECKING:
    from unified_planning.model import Problem as PeerProblem
    from unified_planning.plans import ActionInstance, Plan


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

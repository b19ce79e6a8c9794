"""A world that unified-planning simulates, for `SimulatedRobot`: our plans in other people's code."""

from typing import TYPE_CHECKING

from explicable.errors import PlanError
from explicable.execution.robots.protocol import Fact
from explicable.model.problem import GroundAtom, Problem
from explicable.pddl.unified_planning import to_peer_action, to_peer_problem

if TYPE_CHECKING:
    from unified_planning.model import FNode


class UnifiedPlanningWorld:
    """What is so, as unified-planning's sequential simulator sees it.

    Plans of that library become steps by `explicable.pddl.unified_planning.from_peer_plan`.

    Parameters
    ----------
    problem
        The truth.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> world = UnifiedPlanningWorld(encode(World(("@.*",))).composite)
    >>> world.take(("move", "r1", "c-0-0", "c-0-1")), world.take(("move", "r1", "c-0-0", "c-0-1"))
    (True, False)
    >>> print(*world.hindrances(("move", "r1", "c-0-0", "c-0-1")))
    (not (at r1 c-0-0))
    """

    def __init__(self, problem: Problem) -> None:
        from unified_planning.engines.sequential_simulator import UPSequentialSimulator

        self.problem = to_peer_problem(problem)
        self._simulator = UPSequentialSimulator(self.problem)
        self.state = self._simulator.get_initial_state()

    @property
    def is_goal(self) -> bool:
        """Whether the goal holds."""
        return bool(self._simulator.is_goal(self.state))

    def take(self, action: GroundAtom) -> bool:
        """Carry a step out; False if it is not possible, and then nothing has changed."""
        try:
            after = self._simulator.apply(self.state, to_peer_action(self.problem, action))
        except PlanError:
            return False
        if after is None:
            return False
        self.state = after
        return True

    def hindrances(self, action: GroundAtom) -> tuple[Fact, ...]:
        """Return the facts that are in the way of a step, of those preconditions that are single facts."""
        try:
            instance = to_peer_action(self.problem, action)
        except PlanError:
            return ()
        conditions, _ = self._simulator.get_unsatisfied_conditions(self.state, instance)
        parameters = dict(zip(instance.action.parameters, instance.actual_parameters, strict=True))
        facts = []
        for condition in conditions:
            grounded = condition.substitute(parameters)
            positive = not grounded.is_not()
            atom = grounded if positive else grounded.arg(0)
            if atom.is_fluent_exp():
                facts.append(Fact(_atom(atom), true=not positive))
        return tuple(facts)


def _atom(expression: "FNode") -> GroundAtom:
    return (expression.fluent().name, *(str(argument) for argument in expression.args))

"""What the person takes the state to be while a plan is executed before their eyes."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from explicable.model.problem import GroundAtom
from explicable.model.task import State, Task
from explicable.model.team import TeamTask


@dataclass(frozen=True, slots=True)
class WatchedPlan:
    """A plan as it looks in the mental model.

    Attributes
    ----------
    operators
        Of the mental task, one a step; None for a step that the person takes to be impossible.
    states
        Of the mental task: what the person believes before each step and after the last.
    costs
        What each step costs: by the mental model; by the robot's where the person has no such step.
    """

    operators: tuple[int | None, ...]
    states: tuple[State, ...]
    costs: tuple[int, ...]

    @property
    def num_impossible(self) -> int:
        """How many steps the person takes to be impossible."""
        return sum(operator is None for operator in self.operators)


def watch(team_task: TeamTask, actions: Sequence[GroundAtom]) -> WatchedPlan:
    """Execute a plan for a person to see.

    A step that the mental model allows has the effects that the mental model says. A step that it does not
    allow is taken note of as it happens: what it really makes true is true for the person too, and what it
    really makes false is false. So what the person sees never stops the plan, and teaches them nothing else.

    Parameters
    ----------
    actions
        A plan of the composite task, from the initial state.

    Raises
    ------
    PlanError
        If the composite task does not allow a step.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.model.grounding import ground_team
    >>> team_task = ground_team(encode(World(("@*",))))
    >>> watched = watch(team_task, [("move", "r1", "c-0-0", "c-0-1")])
    >>> team_task.mental.holds(("at", "r1", "c-0-1"), watched.states[-1])
    True
    """
    task, mental = team_task.task, team_task.mental
    execution = task.execute(actions)
    states = [mental.initial_state]
    operators = []
    for number, action in enumerate(actions):
        operator = applicable_operator(mental, states[-1], action)
        operators.append(operator)
        if operator is None:
            before, after = (task.atoms(state) for state in execution.states[number : number + 2])
            states.append(revise(mental, states[-1], false=before - after, true=after - before))
        else:
            states.append(mental.successor(states[-1], operator))
    costs = (
        task.cost(own) if operator is None else mental.cost(operator)
        for operator, own in zip(operators, execution.operators, strict=True)
    )
    return WatchedPlan(tuple(operators), tuple(states), tuple(costs))


def applicable_operator(task: Task, state: State, action: GroundAtom) -> int | None:
    """Return the operator by which a state allows an action, if it does."""
    return next((o for o in task.operators_of(action) if task.is_applicable(state, o)), None)


def revise(task: Task, state: State, *, false: Iterable[GroundAtom], true: Iterable[GroundAtom]) -> State:
    """Return the state with some atoms made false, then some made true.

    Atoms that are no facts of the task are left as they are. What becomes true takes the place of what can't
    be true beside it.
    """
    core = task.core
    facts = {fact for atom in task.atoms(state) if (fact := task.fact_number(atom)) is not None}
    facts.difference_update(fact for atom in false if (fact := task.fact_number(atom)) is not None)
    for fact in (fact for atom in true if (fact := task.fact_number(atom)) is not None):
        facts.difference_update(core.variable_facts(core.fact_variable(fact)))
        facts.add(fact)
    return task.state_of(task.fact(fact) for fact in sorted(facts))

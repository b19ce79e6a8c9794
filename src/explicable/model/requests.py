"""What human steps ask for (architecture page, "Who acts"); `TeamTables` of the core holds the same rule."""

from dataclasses import dataclass

from explicable.model.problem import GroundAtom
from explicable.model.task import Task
from explicable.model.team import TeamProblem


@dataclass(frozen=True, slots=True)
class Request:
    """What a human step asks for.

    Parameters
    ----------
    action
        The human step.
    permits
        The atoms by which it asks; once they are all gone, the request is withdrawn.
    fulfilled_by
        The robots' actions of which one fulfils it.
    """

    action: GroundAtom
    permits: frozenset[GroundAtom]
    fulfilled_by: frozenset[GroundAtom]


def find_requests(problem: TeamProblem, task: Task) -> dict[GroundAtom, Request]:
    """Find what each human step asks for; steps that ask for nothing are left out.

    It asks by the atoms that it adds, in any case and not just on a condition, that name an object, that some
    robot's operator needs, and that no human step with other arguments adds. The human who says it is not one
    of the arguments that matter, nor does the schema.

    Parameters
    ----------
    problem
        Says whose each action is.
    task
        A grounding of the team's actions.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.model.grounding import ground
    >>> problem = encode(World(("@*",)))
    >>> find_requests(problem, ground(problem.composite))["command", "person", "c-0-1"].fulfilled_by
    frozenset({('visit-room', 'r1', 'c-0-1')})
    """
    operators = [o for o in range(task.num_operators) if task.action(o)]  # what is auxiliary is nobody's
    human = {o for o in operators if problem.agent_of(task.action(o)).kind == "human"}
    arguments: dict[int, set[GroundAtom]] = {}  # with which human steps add a fact
    for operator in human:
        for fact in task.core.adds(operator):
            arguments.setdefault(fact, set()).add(task.action(operator)[2:])
    permits = {
        fact
        for fact, said in arguments.items()
        if len(said) == 1 and len(task.fact(fact)) > 1 and task.fact(fact)[0] != "not"
    }
    needed_by: dict[int, set[GroundAtom]] = {}
    for operator in set(operators) - human:
        for fact in permits.intersection(task.core.preconditions(operator)):
            needed_by.setdefault(fact, set()).add(task.action(operator))
    requests = {}
    for operator in sorted(human):
        facts = [fact for fact in task.core.adds(operator) if fact in needed_by]
        if facts:
            action = task.action(operator)
            requests[action] = Request(
                action=action,
                permits=frozenset(map(task.fact, facts)),
                fulfilled_by=frozenset().union(*(needed_by[fact] for fact in facts)),
            )
    return requests

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

    def __hash__(self) -> int:
        return hash(self.action)  # which tells one problem's requests apart


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
    human, robots = _split(problem, task)
    arguments: dict[int, set[GroundAtom]] = {}  # with which human steps add a fact
    for operator, action in human:
        for fact in task.core.adds(operator):
            arguments.setdefault(fact, set()).add(action[2:])
    permits = {
        fact
        for fact, said in arguments.items()
        if len(said) == 1 and len(task.fact(fact)) > 1 and task.fact(fact)[0] != "not"
    }
    needed_by: dict[int, set[GroundAtom]] = {}
    needs, ends = (task.core.array(f"preconditions.{part}").tolist() for part in ("values", "offsets"))
    for operator, action in robots:
        for fact in permits.intersection(needs[ends[operator] : ends[operator + 1]]):
            needed_by.setdefault(fact, set()).add(action)
    requests = {}
    for operator, action in human:
        facts = [fact for fact in task.core.adds(operator) if fact in needed_by]
        if facts:
            requests[action] = Request(
                action=action,
                permits=frozenset(map(task.fact, facts)),
                fulfilled_by=frozenset().union(*(needed_by[fact] for fact in facts)),
            )
    return requests


Steps = list[tuple[int, GroundAtom]]


def _split(problem: TeamProblem, task: Task) -> tuple[Steps, Steps]:
    """Return the operators of humans and those of robots, with actions; what is auxiliary is nobody's."""
    steps: dict[str, Steps] = {"human": [], "robot": []}
    for operator, action in enumerate(task.actions):
        if action:
            steps[problem.agent_of(action).kind].append((operator, action))
    return steps["human"], steps["robot"]

"""What a game asks of a planner, and how far a new plan is from the one announced before."""

from collections.abc import Callable
from dataclasses import dataclass

from explicable.model.plan import Actions
from explicable.model.requests import Request
from explicable.model.task import State
from explicable.model.team import TeamProblem
from explicable.search import Outcome


@dataclass(frozen=True, slots=True)
class Situation:
    """What a plan is asked for.

    Parameters
    ----------
    problem
        The team problem with all that the robot has found out, so that the past can be executed in it.
    past
        The steps already done, from the problem's initial state: what is explicable depends on them.
    announced
        What is left of the plan that the team follows; empty if there is none that leads to the goal.
    state
        Where the game stands, in the truth of the game's setting.
    request
        What was last asked for and not yet got, if anything.
    """

    problem: TeamProblem
    past: Actions
    announced: Actions
    state: State
    request: Request | None = None


@dataclass(frozen=True, slots=True)
class Proposal:
    """What a planner answers: how its search ended, and the joint plan from now on if there is one."""

    outcome: Outcome
    actions: Actions = ()


Planner = Callable[[Situation], Proposal]
"""Plans the rest of a game."""


def num_changes(announced: Actions, proposed: Actions) -> int:
    """Return how many announced steps a proposal does not keep, in their order.

    The number of announced steps less the length of the longest common subsequence: what is added changes
    nothing that was announced.

    Examples
    --------
    >>> visit_a, visit_b, wait = ("visit", "a"), ("visit", "b"), ("wait",)
    >>> (
    ...     num_changes((visit_a, visit_b), (wait, visit_a, visit_b)),
    ...     num_changes((visit_a, visit_b), (visit_b, visit_a)),
    ... )
    (0, 1)
    """
    start = next(
        (i for i, (a, b) in enumerate(zip(announced, proposed, strict=False)) if a != b),
        min(len(announced), len(proposed)),
    )
    announced, proposed = announced[start:], proposed[start:]
    row = [0] * (len(proposed) + 1)
    for step in announced:
        corner = 0
        for column, other in enumerate(proposed, start=1):
            above = row[column]
            row[column] = corner + 1 if step == other else max(above, row[column - 1])
            corner = above
    return len(announced) - row[-1]

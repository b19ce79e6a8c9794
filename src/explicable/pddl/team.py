"""Team problems as PDDL files: the robot's domain and problem, and the human's."""

from pathlib import Path

from explicable.model.team import TeamProblem
from explicable.pddl.parser import read_pair
from explicable.pddl.source import Warn


def read_team_problem(
    domain: str | Path,
    problem: str | Path,
    human_domain: str | Path | None = None,
    human_problem: str | Path | None = None,
    *,
    warn: Warn | None = None,
) -> TeamProblem:
    """Read a team problem.

    Parameters
    ----------
    domain, problem
        The robot's model ``M_R``.
    human_domain, human_problem
        The approximate human planning model ``~M_H``; where one is left out, the robot's file stands for it.
        With neither, the robot knows of no difference.
    warn
        Called with each `PDDLWarning`.

    Raises
    ------
    PDDLError
        With file, line and column.

    Examples
    --------
    >>> read_team_problem("missing.pddl", "problem.pddl")
    Traceback (most recent call last):
    explicable.errors.PDDLError: missing.pddl: can't be read: No such file or directory
    """
    robot = read_pair(domain, problem, warn=warn)
    if human_domain is None and human_problem is None:
        return TeamProblem(robot)
    return TeamProblem(robot, read_pair(human_domain or domain, human_problem or problem, warn=warn))

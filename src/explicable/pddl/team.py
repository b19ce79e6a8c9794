"""Team problems as PDDL files: the robot's domain and problem, and the human's."""

from collections.abc import Sequence
from pathlib import Path

from explicable.errors import ConflictError, PDDLError
from explicable.model.team import Conflict, TeamProblem, find_conflicts
from explicable.pddl.parser import read_pair
from explicable.pddl.places import find_declaration
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
        With file, line and column; a `ConflictError` if the two models can't be composed.

    Examples
    --------
    >>> read_team_problem("missing.pddl", "problem.pddl")
    Traceback (most recent call last):
    explicable.errors.PDDLError: missing.pddl: can't be read: No such file or directory
    """
    robot = read_pair(domain, problem, warn=warn)
    if human_domain is None and human_problem is None:
        return TeamProblem(robot)
    human = read_pair(human_domain or domain, human_problem or problem, warn=warn)
    if conflicts := find_conflicts(robot, human):
        own, theirs = (problem, domain), (human_problem or problem, human_domain or domain)
        raise ConflictError([_placed(conflict, own, theirs) for conflict in conflicts])
    return TeamProblem(robot, human)


def _placed(conflict: Conflict, own: Sequence[str | Path], theirs: Sequence[str | Path]) -> PDDLError:
    """Say where both models declare what they conflict about."""
    where = {}
    for side, paths in (("robot", own), ("human", theirs)):
        for path in paths:
            if (place := find_declaration(path, conflict.kind, conflict.name)) is not None:
                where[side] = (path, *place)
    message = str(conflict)
    if "robot" in where:
        message += f" (there: {':'.join(map(str, where['robot']))})"
    path, line, column = where.get("human", (theirs[-1], None, None))
    return PDDLError(message, path=path, line=line, column=column)

"""Team problems as PDDL files: the robot's domain and problem, and the human's."""

from collections.abc import Sequence
from pathlib import Path

from explicable.errors import ConflictError, PDDLError
from explicable.model.team import Conflict, TeamProblem, explain_undecided, find_conflicts, find_undecided
from explicable.pddl.files import read_pair
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
    own, theirs = (problem, domain), (human_problem or problem, human_domain or domain)
    human = None
    if human_domain is not None or human_problem is not None:
        human = read_pair(theirs[1], theirs[0], warn=warn)
        if conflicts := find_conflicts(robot, human):
            raise ConflictError([_placed(conflict, own, theirs) for conflict in conflicts])
    team = TeamProblem(robot, human)
    for name in find_undecided(team.composite):
        raise _at_declaration(name, (*theirs, *own))
    return team


def _at_declaration(name: str, paths: Sequence[str | Path]) -> PDDLError:
    """Say where an object is declared that is both a robot and a human."""
    places = ((path, find_declaration(path, "object", name)) for path in paths)
    path, place = next((path, place) for path, place in places if place is not None)
    return PDDLError(explain_undecided(name), path=path, line=place[0], column=place[1])


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

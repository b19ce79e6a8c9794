"""Reading and writing PDDL."""

from explicable.pddl.files import read_domain, read_pair, read_problem
from explicable.pddl.parser import parse_domain, parse_problem
from explicable.pddl.source import PDDLWarning
from explicable.pddl.team import read_team_problem
from explicable.pddl.writer import format_domain, format_problem

__all__ = [
    "PDDLWarning",
    "format_domain",
    "format_problem",
    "parse_domain",
    "parse_problem",
    "read_domain",
    "read_pair",
    "read_problem",
    "read_team_problem",
]

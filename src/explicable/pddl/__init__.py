"""Reading and writing PDDL."""

from explicable.pddl.parser import parse_domain, parse_problem, read_domain, read_pair, read_problem
from explicable.pddl.source import PDDLWarning

__all__ = ["PDDLWarning", "parse_domain", "parse_problem", "read_domain", "read_pair", "read_problem"]

"""PDDL files, read whole and parsed."""

from pathlib import Path

from explicable.errors import PDDLError
from explicable.model.problem import Domain, Problem
from explicable.pddl.parser import parse_domain, parse_problem
from explicable.pddl.source import Warn


def read_domain(path: str | Path, *, warn: Warn | None = None) -> Domain:
    """Read a domain file; see `parse_domain`.

    Examples
    --------
    >>> read_domain("missing.pddl")
    Traceback (most recent call last):
    explicable.errors.PDDLError: missing.pddl: can't be read: No such file or directory
    """
    return parse_domain(_read_text(path), path, warn=warn)


def read_problem(path: str | Path, domain: Domain, *, warn: Warn | None = None) -> Problem:
    """Read a problem file; see `parse_problem`.

    Examples
    --------
    >>> domain = parse_domain("(define (domain lamp))")
    >>> read_problem("missing.pddl", domain)
    Traceback (most recent call last):
    explicable.errors.PDDLError: missing.pddl: can't be read: No such file or directory
    """
    return parse_problem(_read_text(path), domain, path, warn=warn)


def read_pair(domain_path: str | Path, problem_path: str | Path, *, warn: Warn | None = None) -> Problem:
    """Read a domain file and a problem file; the problem holds the domain.

    Examples
    --------
    >>> read_pair("missing.pddl", "problem.pddl")
    Traceback (most recent call last):
    explicable.errors.PDDLError: missing.pddl: can't be read: No such file or directory
    """
    return read_problem(problem_path, read_domain(domain_path, warn=warn), warn=warn)


def _read_text(path: str | Path) -> str:
    try:
        return Path(path).read_bytes().decode(errors="surrogateescape")
    except OSError as error:
        raise PDDLError(f"can't be read: {error.strerror}", path=path) from error

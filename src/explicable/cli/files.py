"""What the commands share: reading a team problem from files named on the command line."""

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.errors import InputError, TraceError
from explicable.model.team import TeamProblem

if TYPE_CHECKING:
    from explicable.labelling import Trace

INPUT_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)
OUTPUT_FILE = click.Path(dir_okay=False, path_type=Path)


def team_problem_arguments(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the arguments DOMAIN and PROBLEM and the options for the human's model."""

    @click.argument("domain", type=INPUT_FILE)
    @click.argument("problem", type=INPUT_FILE)
    @click.option(
        "--human-domain",
        type=INPUT_FILE,
        help="The person's model as the robot knows it: the person's own actions, and what the person"
        " believes that the robot can do. Default: DOMAIN.",
    )
    @click.option(
        "--human-problem",
        type=INPUT_FILE,
        help="The problem as the person sees it. Default: PROBLEM.",
    )
    @functools.wraps(command)
    def with_problem(
        domain: Path, problem: Path, human_domain: Path | None, human_problem: Path | None, **options: Any
    ) -> Any:
        paths = TeamProblemPaths(domain, problem, human_domain, human_problem)
        return command(paths, **options)

    return with_problem


class TeamProblemPaths:
    """The files of a team problem, not yet read."""

    def __init__(
        self, domain: Path, problem: Path, human_domain: Path | None, human_problem: Path | None
    ) -> None:
        self.paths = domain, problem, human_domain, human_problem

    def read(self) -> TeamProblem:
        """Read the robot's problem, and the human's if it was named; warnings go to standard error."""
        from explicable.pddl import read_team_problem

        return read_team_problem(*self.paths, warn=_warn)


@contextmanager
def naming(path: Path, kind: type[InputError]) -> Iterator[None]:
    """Let errors of a kind that don't say which file they are about name this one."""
    try:
        yield
    except kind as error:
        error.path = error.path or path
        raise


def read_labelled_traces(*files: Path) -> "list[Trace]":
    """Read traces to learn from: at least one label must be there."""
    from explicable.labelling import read_traces

    traces = read_traces(*files)
    if not any(step.label is not None for trace in traces for step in trace.steps):
        raise TraceError("no step has a label: there is nothing to learn from", path=files[0])
    return traces


def _warn(warning: object) -> None:
    click.echo(f"explicable: warning: {warning}", err=True)

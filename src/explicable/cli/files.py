"""What the commands share: reading a team problem from files named on the command line."""

import functools
import math
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli.printing import warn
from explicable.errors import InputError, LabellerError, PlanError
from explicable.model.plan import find_step, read_plan
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller
    from explicable.model.team import TeamTask
    from explicable.planning import Telling

INPUT_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


class OutputPath(click.Path):
    """Where a command will write: what cannot be is refused at once, not after all the work."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path."""
        path: Any = super().convert(value, param, ctx)
        place = Path(os.path.realpath(path))
        if place.is_file():
            place = place.parent  # a file is replaced, not written to
        while not place.exists():
            place = place.parent  # folders that are missing will be made
            if place.exists() and not place.is_dir():
                self.fail(f"'{path}' would lie in '{place}', which is no directory", param, ctx)
        if not self.file_okay and not place.is_dir():
            self.fail(f"'{path}' is no directory", param, ctx)
        if not os.access(place, os.W_OK):
            self.fail(f"'{place}' is not writable", param, ctx)
        return path


OUTPUT_FILE = OutputPath(dir_okay=False, path_type=Path)
OUTPUT_FOLDER = OutputPath(file_okay=False, path_type=Path)


class FiniteRange(click.FloatRange):
    """A finite number between bounds; click's own ranges let NaN and infinity through."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number."""
        number: float = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value!r} is not a finite number", param, ctx)
        return number


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
    @click.option(
        "--ignore-human",
        is_flag=True,
        help="Take it that the person sees the task as it is; of their files only the humans' actions count.",
    )
    @functools.wraps(command)
    def with_problem(
        domain: Path,
        problem: Path,
        human_domain: Path | None,
        human_problem: Path | None,
        ignore_human: bool,
        **options: Any,
    ) -> Any:
        paths = TeamProblemPaths(domain, problem, human_domain, human_problem, ignore_human=ignore_human)
        return command(paths, **options)

    return with_problem


class TeamProblemPaths:
    """The files of a team problem, not yet read."""

    def __init__(
        self,
        domain: Path,
        problem: Path,
        human_domain: Path | None,
        human_problem: Path | None,
        *,
        ignore_human: bool = False,
    ) -> None:
        self.paths = domain, problem, human_domain, human_problem
        self.ignore_human = ignore_human

    def read(self) -> TeamProblem:
        """Read the robot's problem, and the human's if it was named; warnings go to standard error."""
        from explicable.pddl import read_team_problem

        problem = read_team_problem(*self.paths, warn=warn)
        return TeamProblem(problem.composite) if self.ignore_human else problem

    def ground(self) -> "TeamTask":
        """Read and ground the problem; warn if the person can't see a way to the goal."""
        from explicable.model.grounding import ground_team

        return warn_of_hopeless(ground_team(self.read()))


def warn_of_hopeless(team_task: "TeamTask") -> "TeamTask":
    """Return the team task; warn if in the human model the goal can't be reached."""
    if team_task.problem.human is not None and not team_task.mental.goal_reachable:
        warn(
            "in the human model the goal can't be reached, so the person expects no plan;"
            " --ignore-human goes on without that model"
        )
    return team_task


def load_labeller(path: Path, problem: TeamProblem) -> "Labeller":
    """Read a labeller for a problem; warn of the robots' actions that it has never seen.

    Raises
    ------
    LabellerError
        If the file is no labeller, or was trained on another domain; names the file.
    """
    from explicable.labelling import Labeller

    labeller = Labeller.load(path)
    with naming(path, LabellerError):
        labeller.check_domain(problem)
    if unknown := labeller.unknown_schemas(problem):
        warn(f"{path}: the labeller has never seen {', '.join(unknown)}: what it says of these is a guess")
    return labeller


UNFAMILIAR_SHARE = 1 / 3
"""Of the robots' steps: where more show what nobody has labelled, a plan is unlike those that were."""


def warn_of_unfamiliar(plan: "LabelledPlan | None") -> None:
    """Warn if a plan, if there is one, is unlike those from which the labeller learned."""
    number, num_steps = (sum(plan.unfamiliar), sum(plan.is_robot)) if plan else (0, 0)
    if number > UNFAMILIAR_SHARE * num_steps:
        warn(
            f"{number} of the robots' {num_steps} steps show something that no trace showed in training:"
            " what people make of this plan is a guess; let some label it, and train on that as well"
        )


def read_steps(path: Path, problem: TeamProblem) -> tuple[GroundAtom, ...]:
    """Read a plan for a problem; leave out what it tells the person (`explicable tell`), with a warning."""
    from explicable.planning.tellings import telling_schema

    actions, telling = read_plan(path), telling_schema(problem)
    steps = tuple(action for action in actions if action[0] != telling)
    if left_out := len(actions) - len(steps):
        warn(f"{path}: tellings left out: {left_out}; the person is taken to be told nothing")
    return steps


def find_line(path: Path, step: int, problem: TeamProblem) -> int | None:
    """Give the line in which a step of `read_steps` stands; steps and lines from 1."""
    from explicable.planning.tellings import telling_schema

    return find_step(path, step, without=telling_schema(problem))


def read_told_steps(path: Path, problem: TeamProblem) -> "tuple[tuple[GroundAtom, ...], tuple[Telling, ...]]":
    """Read a plan for a problem, and what it tells the person."""
    from explicable.planning.tellings import part_tellings

    try:
        return part_tellings(problem, read_plan(path))
    except PlanError as error:
        error.path = path
        if error.step is not None:
            error.line, error.step = find_step(path, error.step), None
        raise


@contextmanager
def naming_plan(path: Path, problem: TeamProblem) -> Iterator[None]:
    """Let errors about a step of a plan name the plan's file, and the line."""
    try:
        yield
    except PlanError as error:
        if error.path is None:
            error.path = path
            error.line = None if error.step is None else find_line(path, error.step, problem)
        raise


@contextmanager
def naming(path: Path, kind: type[InputError]) -> Iterator[None]:
    """Let errors of a kind that don't say which file they are about name this one."""
    try:
        yield
    except kind as error:
        error.path = error.path or path
        raise

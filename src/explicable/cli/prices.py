"""Options of `plan` and `tell`: what else a plan is charged for, and for how long it is improved."""

import functools
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli.files import INPUT_FILE, FiniteRange
from explicable.cli.printing import echo
from explicable.cli.progress import is_watched
from explicable.cli.trace_files import read_human_model

if TYPE_CHECKING:
    from explicable.planning import HumanModel


DEFAULT_ALPHA = 2.0
"""`explicable.planning.team_plan.DEFAULT_ALPHA`, which would take long to import only to show it."""

alpha_option = click.option(
    "--alpha", type=float, default=DEFAULT_ALPHA, show_default=True, help="Price of one inexplicable step."
)


@dataclass(frozen=True, slots=True)
class HumanSteps:
    """What the plan's human steps are charged, and where it is learned what people do."""

    weight: float
    people_file: Path | None

    def model(self) -> "HumanModel | None":
        """Learn what people do from their traces; None if nothing is charged."""
        return None if self.people_file is None else read_human_model(self.people_file)


def human_step_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `--charge-human-steps` and `--people`; it receives `human_steps`."""

    @click.option(
        "--charge-human-steps",
        "weight",
        metavar="W",
        type=FiniteRange(min=0),
        default=0.0,
        show_default=True,
        help="Price, in the unit of cost, of each nat of surprise at what the plan makes the person do."
        " Needs --people.",
    )
    @click.option(
        "--people",
        "people_file",
        metavar="TRACES",
        type=INPUT_FILE,
        help="Learn from these traces what people do.",
    )
    @functools.wraps(command)
    def with_human_steps(*arguments: Any, weight: float, people_file: Path | None, **options: Any) -> Any:
        if weight > 0 and people_file is None:
            raise click.UsageError("--charge-human-steps needs --people TRACES, to know what people do")
        return command(*arguments, human_steps=HumanSteps(weight, people_file), **options)

    return with_human_steps


def improvement_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `--improve-time` and `--gap`."""
    command = click.option(
        "--gap",
        type=FiniteRange(min=0, max=1, max_open=True),
        default=0.0,
        show_default=True,
        help="Stop once no plan can be better by more than this share of J.",
    )(command)
    return click.option(
        "--improve-time",
        type=FiniteRange(min=0),
        default=1.0,
        show_default=True,
        help="Seconds for better plans than the first; Ctrl-C ends it with the best so far.",
    )(command)


def show_progress() -> Callable[[float], None] | None:
    """Return what says on standard error, if that is a terminal, how good the best plan is."""
    if not is_watched():
        return None
    started = time.monotonic()

    def say(objective: float) -> None:
        echo(f"{time.monotonic() - started:6.1f} s  J = {objective:.3f}", err=True)

    return say

"""`explicable simulate`: labelled traces of any team problem, from simulated participants."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from explicable.cli.files import (
    INPUT_FILE,
    OUTPUT_FILE,
    TeamProblemPaths,
    naming_plan,
    read_steps,
    team_problem_arguments,
)
from explicable.cli.printing import echo, warn
from explicable.cli.progress import working

if TYPE_CHECKING:
    from explicable.execution import Family
    from explicable.model.team import TeamProblem


way_option = click.option(
    "--way",
    type=click.Choice(["commanded", "autonomous", "mixed"]),
    default="mixed",
    show_default=True,
    help="commanded: the robots wait until something is asked for. autonomous: they go ahead unasked. mixed:"
    " commanded, but in one of four games they go ahead unasked and nobody has said so.",
)


def participant_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options that say who plays, how often, and where the traces go."""
    for option in (
        click.option("-o", "--output", type=OUTPUT_FILE, required=True, help="Trace file to write."),
        click.option(
            "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of all chance."
        ),
        click.option("--families", type=INPUT_FILE, help="Families from this TOML file (docs/execution.md)."),
        click.option(
            "--family", default="myopic", show_default=True, help="Family of simulated participants."
        ),
    ):
        command = option(command)
    return command


def find_family(name: str, path: Path | None) -> "Family":
    """Return a family of simulated participants, from a file or built in.

    Raises
    ------
    click.UsageError
        If there is none of this name.
    """
    from explicable.execution import builtin_families
    from explicable.execution.participants import read_families

    families = read_families(path) if path else builtin_families()
    if name not in families:
        raise click.UsageError(
            f"no family of participants is called {name!r}: choose {', '.join(families) or 'another file'}"
        )
    return families[name]


def play_and_write(problems: "Iterable[TeamProblem]", family: "Family", output: Path, **options: Any) -> None:
    """Let participants of a family play, write their traces, and say how many games came to their goal."""
    from explicable.execution import Ending, simulate_study
    from explicable.labelling import write_traces

    with working("playing"):
        episodes = simulate_study(problems, family, **options)
    write_traces(output, [episode.trace for episode in episodes])
    echo(f"{output}: traces of simulated participants: {len(episodes)}", err=True)
    for ending in Ending:
        number = sum(episode.ending is ending for episode in episodes)
        if number and ending is not Ending.REACHED:
            warn(f"{number} of {len(episodes)} games: {ending.value}")


@click.command()
@team_problem_arguments
@click.option("--num", type=click.IntRange(min=1), default=1, show_default=True, help="Number of traces.")
@way_option
@click.option(
    "--plan",
    "plan_files",
    type=INPUT_FILE,
    multiple=True,
    help="Let them watch and label this plan in the place of playing; may be repeated.",
)
@participant_options
def simulate(
    paths: TeamProblemPaths,
    num: int,
    way: str,
    plan_files: tuple[Path, ...],
    family: str,
    families: Path | None,
    seed: int,
    output: Path,
) -> None:
    """Let simulated participants play the team problem DOMAIN PROBLEM with robots and label their steps.

    Simulated participants are test instruments: what they say is no evidence about people.
    """
    who = find_family(family, families)
    if plan_files:
        if click.get_current_context().get_parameter_source("way") is ParameterSource.COMMANDLINE:
            raise click.UsageError("--way says how they play; with --plan they only watch")
        _show_and_write(paths, plan_files, who, output, num_traces=num, seed=seed)
    else:
        play_and_write([paths.ground().problem], who, output, num_traces=num, seed=seed, way=way)


def _show_and_write(
    paths: TeamProblemPaths, plan_files: Sequence[Path], family: "Family", output: Path, **options: Any
) -> None:
    from explicable.execution import show
    from explicable.labelling import write_traces

    team_task = paths.ground()
    plans = []
    for path in plan_files:
        with naming_plan(path, team_task.problem):
            plans.append(read_steps(path, team_task.problem))
            team_task.task.execute(plans[-1])
    with working("showing"):
        traces = show(team_task.problem, plans, family, **options)
    write_traces(output, traces)
    echo(f"{output}: plans labelled by simulated participants: {len(traces)}", err=True)

"""`explicable play`: a person and a robot at work on a map."""

import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from explicable.cli.files import INPUT_FILE, OUTPUT_FILE, FiniteRange, load_labeller
from explicable.cli.first_response import map_argument, semantics_option
from explicable.cli.prices import alpha_option
from explicable.cli.printing import echo
from explicable.cli.trace_files import read_human_model

if TYPE_CHECKING:
    from collections.abc import Callable

    from explicable.execution import Planner, Run, Setting, SimulatedPerson
    from explicable.first_response import Semantics


@click.command()
@map_argument
@click.option("--labeller", type=INPUT_FILE, help="Let the robot plan what this labeller says people expect.")
@alpha_option
@click.option(
    "--people",
    metavar="TRACES",
    type=INPUT_FILE,
    help="With --labeller: foresee what you will ask for by what people did in these traces.",
)
@click.option(
    "--strategy",
    type=click.Choice(["follower", "nearest", "ff"]),
    default="nearest",
    show_default=True,
    help="How the robot plans without a labeller.",
)
@click.option("--ask/--no-ask", default=True, show_default=True, help="Ask about each step of the robot.")
@click.option(
    "--simulated", metavar="FAMILY", help="Let a simulated participant of this family play in your place."
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Seed of the participant's chance.",
)
@click.option("--name", default="me", show_default=True, help="Your name in the record.")
@click.option(
    "--pause",
    type=FiniteRange(0, 60),
    default=0.0,
    show_default=True,
    help="Seconds before a robot's step.",
)
@semantics_option
@click.option("-o", "--output", type=OUTPUT_FILE, help="Write the game to this file, for replay and train.")
def play(
    map_file: Path,
    labeller: Path | None,
    alpha: float,
    people: Path | None,
    strategy: str,
    ask: bool,
    simulated: str | None,
    seed: int,
    name: str,
    pause: float,
    semantics: "Semantics",
    output: Path | None,
) -> None:
    """Play MAP with a robot: you command, it searches the rooms, you say whether its steps make sense.

    You see the floor plan from before the disaster; the robot sees what has changed. Ctrl-C or the end of
    input ends the game; what was played is written all the same.
    """
    from explicable import first_response as maps
    from explicable.cli.keyboard import Keyboard, KeyboardPerson
    from explicable.execution import ClosedLoop, Person, observable_facts, prepare, record, write_episode
    from explicable.planning import check_alpha

    check_alpha(alpha)
    world = maps.read_map(map_file)
    problem = maps.encode(world, semantics)
    observable = observable_facts(problem)
    setting = prepare(problem, observable)
    planner = _planner(setting, labeller, alpha, people, strategy)
    person: Person
    if simulated is not None:
        person = _participant(setting, simulated, seed)
        loop = ClosedLoop(setting, planner, person)
    else:
        person = KeyboardPerson(name, setting, Keyboard(world), ask=ask, pause=lambda: time.sleep(pause))
        loop = ClosedLoop(setting, planner, person, watch=person.look)
        person.quit = loop.abort
    notes = {"strategy": "explicable" if labeller else strategy, "alpha": alpha}
    text = maps.format_map(world)

    def keep(played: "Run") -> None:
        if output is not None:
            write_episode(
                output, record(played, setting.truth.task, observable=observable, map_text=text, notes=notes)
            )

    try:
        played = loop.run()
    except KeyboardInterrupt:
        keep(loop.result())
        raise
    keep(played)
    echo(_sum_up(played))


def _sum_up(played: "Run") -> str:
    trace = played.episode.trace
    labels = [step.is_explicable for step in trace.steps if step.label is not None]
    return (
        f"{played.episode.ending.value}: {len(trace.steps)} steps; {labels.count(False)} of {len(labels)}"
        f" made no sense to {trace.annotator}, who did otherwise than predicted {played.num_deviations} times"
    )


def _participant(setting: "Setting", family: str, seed: int) -> "SimulatedPerson":
    import numpy as np

    from explicable.cli.simulate import find_family
    from explicable.execution import SimulatedPerson

    participant = find_family(family, None).draw(seed, np.random.default_rng((seed, 0)))
    return SimulatedPerson(setting, participant, np.random.default_rng((seed, 1)))


def _planner(
    setting: "Setting", labeller: Path | None, alpha: float, people: Path | None, strategy: str
) -> "Planner":
    from explicable.evaluation.replanning import ExplicablePlanner, Prices
    from explicable.evaluation.strategies import ClassicalPlanner, NearestPlanner, follow

    if labeller is not None:
        human_model = read_human_model(people) if people else None
        knows = load_labeller(labeller, setting.problem)
        return ExplicablePlanner(knows, Prices(alpha=alpha), human_model=human_model)
    if people is not None:
        raise click.UsageError("--people needs --labeller: other strategies foresee nothing")
    planners: dict[str, Callable[[], Planner]] = {
        "follower": lambda: follow,
        "nearest": lambda: NearestPlanner(setting),
        "ff": ClassicalPlanner,
    }
    return planners[strategy]()

"""`explicable play` and `explicable replay`: a person and a robot at work, and their games on record."""

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from explicable.cli import EXIT_BAD_INPUT
from explicable.cli.files import (
    INPUT_FILE,
    OUTPUT_FILE,
    FiniteRange,
    load_labeller,
    naming,
)
from explicable.cli.first_response import map_argument, semantics_option
from explicable.cli.outcomes import json_option
from explicable.cli.printing import complain, echo
from explicable.cli.progress import working
from explicable.cli.trace_files import read_human_model
from explicable.errors import PlanError
from explicable.model.files import write_whole
from explicable.model.plan import format_action

if TYPE_CHECKING:
    from collections.abc import Callable

    from explicable.execution import EpisodeRecord, Planner, Run, Setting, SimulatedPerson
    from explicable.first_response import Semantics

MAX_TOLD = 10  # one wrong event makes most that follow it wrong


@click.command()
@map_argument
@click.option("--labeller", type=INPUT_FILE, help="Let the robot plan what this labeller says people expect.")
@click.option("--alpha", type=float, default=1.0, show_default=True, help="Price of an inexplicable step.")
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
    labels = [step.is_explicable for step in played.episode.trace.steps if step.label is not None]
    echo(
        f"{played.episode.ending.value}: {len(played.episode.trace.steps)} steps; {labels.count(False)} of"
        f" {len(labels)} made no sense to {person.name}, who did otherwise than predicted"
        f" {played.num_deviations} times"
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


@click.command()
@click.argument("episode", type=INPUT_FILE)
@click.option("--svg", type=OUTPUT_FILE, help="Draw the game to this file, if it was played on a map.")
@click.option(
    "--step-time",
    type=FiniteRange(0, 60),
    default=0.5,
    show_default=True,
    help="Seconds a step in the picture, which plays itself; 0: it stands still.",
)
@click.option("--trace", type=OUTPUT_FILE, help="Write the steps with the answers to this trace file.")
@json_option
def replay(episode: Path, svg: Path | None, step_time: float, trace: Path | None, as_json: bool) -> int:
    """Play the game on record in EPISODE again, event by event, and check that the same comes of it.

    Exit code 3 if it does not; then neither picture nor trace is written.
    """
    from explicable.execution import read_episode
    from explicable.execution import replay as play_again
    from explicable.labelling import write_traces

    recorded = read_episode(episode)
    with working(f"playing {len(recorded.events)} events again"):
        replayed = play_again(recorded)
    is_true = not replayed.differences  # else nothing is made of it
    if svg is not None and is_true:
        with naming(episode, PlanError):
            drawing = _draw(recorded, step_time)
        write_whole(svg, drawing)
    if trace is not None and is_true:
        write_traces(trace, [recorded.trace])
    if as_json:
        summary = {
            "ending": recorded.trace.notes.get("ending"),
            "steps": len(recorded.trace.steps),
            "events": len(recorded.events),
            "deviations": recorded.num_deviations,
            "changes": recorded.num_changes,
            "plans": len(recorded.planning_s),
            "same": is_true,
            "differences": replayed.differences,
        }
        echo(json.dumps(summary))
    else:
        _tell(recorded)
    if not as_json:
        for difference in replayed.differences[:MAX_TOLD]:
            complain(f"{episode}: {difference}")
        if (others := len(replayed.differences) - MAX_TOLD) > 0:
            complain(f"{episode}: and {others} more differences (--json tells all)")
    return EXIT_BAD_INPUT if replayed.differences else 0


def _tell(recorded: "EpisodeRecord") -> None:
    """Print every event, one a line."""
    for event in recorded.events:
        notice = event.notice
        about = [format_action(notice.action)] if notice.action else []
        about += map(str, notice.facts)
        if notice.answer is not None:
            about.append("makes sense" if notice.answer else "makes no sense")
        if notice.plan:
            about.append(f"{len(notice.plan)} steps")
        if notice.reason:
            about.append(notice.reason)
        if event.refusal:
            about.append(f"refused: {event.refusal}")
        echo(f"{event.time_s:9.3f} s  {notice.event.value:16}  {'  '.join(about)}".rstrip())
    echo(f"{recorded.trace.notes.get('ending', 'not ended')}: {len(recorded.trace.steps)} steps")


def _draw(recorded: "EpisodeRecord", step_s: float) -> str:
    from explicable.first_response import parse_map, render

    if recorded.map_text is None:
        raise click.UsageError("the game was not played on a map: it can't be drawn")
    steps = recorded.trace.steps
    return render(
        parse_map(recorded.map_text),
        "robot",
        plan=[step.action for step in steps],
        labels=[step.is_explicable for step in steps],
        title=f"{recorded.trace.annotator}: {recorded.trace.notes.get('ending', '')}".rstrip(": "),
        key=True,
        step_s=step_s,
    )

"""`explicable first-response`: maps of the paper's domain, as files, pictures, PDDL and simulated traces."""

from pathlib import Path

import click

from explicable import first_response as maps
from explicable.cli.files import INPUT_FILE, OUTPUT_FILE, OUTPUT_FOLDER, naming
from explicable.cli.printing import echo
from explicable.cli.simulate import find_family, participant_options, play_and_write, way_option
from explicable.errors import PlanError
from explicable.model.files import write_whole

SEMANTICS = click.Choice(["persistent", "exclusive"])

map_argument = click.argument("map_file", metavar="MAP", type=INPUT_FILE)
semantics_option = click.option(
    "--semantics",
    type=SEMANTICS,
    default="persistent",
    show_default=True,
    help="persistent: a command permits a visit from then on. exclusive: one command is in force at a time.",
)


@click.group()
def first_response() -> None:
    """Search marked rooms after a disaster: the paper's domain."""


@first_response.command()
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the first map."
)
@click.option("--num", type=click.IntRange(min=1), default=1, show_default=True, help="How many maps.")
@click.option(
    "--height", type=click.IntRange(min=1), default=6, show_default=True, help="Rows within the border."
)
@click.option("--width", type=click.IntRange(min=1), default=6, show_default=True, help="Columns within it.")
@click.option("--marks", type=click.IntRange(min=1), default=4, show_default=True, help="Marked rooms.")
@click.option("--robots", type=click.IntRange(min=1), default=1, show_default=True, help="Robots.")
@click.option(
    "-o",
    "--output",
    type=OUTPUT_FOLDER,
    help="Folder for the maps; without it one map goes to standard output.",
)
def generate(
    seed: int, num: int, height: int, width: int, marks: int, robots: int, output: Path | None
) -> None:
    """Make maps in which every marked room can be reached: one for each seed from --seed on."""
    import numpy as np

    if num > 1 and output is None:
        raise click.UsageError("several maps need a folder: --output DIR")
    for number in range(seed, seed + num):
        world = maps.generate(
            np.random.default_rng(number), height=height, width=width, num_marks=marks, num_robots=robots
        )
        name = f"map-{number:03}"
        text = maps.format_map(maps.World(world.rows, {"name": name, "seed": str(number)}))
        if output is None:
            echo(text, nl=False)
        else:
            write_whole(output / f"{name}.map", text)
            echo(output / f"{name}.map")


@first_response.command()
@map_argument
@click.option("-o", "--output", type=OUTPUT_FOLDER, required=True, help="Folder for the four PDDL files.")
@semantics_option
@click.option("--people", type=click.IntRange(min=1), default=1, show_default=True, help="Who command.")
def encode(map_file: Path, output: Path, semantics: maps.Semantics, people: int) -> None:
    """Write MAP as PDDL: domain, problem, human-domain and human-problem."""
    from explicable.labelling import problem_texts

    texts = problem_texts(maps.encode(maps.read_map(map_file), semantics, num_people=people))
    for part, text in texts.items():
        path = output / f"{part.replace('_', '-')}.pddl"
        write_whole(path, text)
        echo(path)


@first_response.command()
@map_argument
@click.option("-o", "--output", type=OUTPUT_FILE, required=True, help="SVG file to write.")
@click.option(
    "--view",
    type=click.Choice(["human", "robot"]),
    default="human",
    show_default=True,
    help="human: the floor plan from before. robot: hidden obstacles shaded.",
)
@click.option("--plan", "plan_file", type=INPUT_FILE, help="Draw this plan into the map.")
def render(map_file: Path, output: Path, view: maps.View, plan_file: Path | None) -> None:
    """Draw MAP as SVG, as the person or as the robot sees it."""
    from explicable.model.plan import read_plan

    world = maps.read_map(map_file)
    actions = read_plan(plan_file) if plan_file else None
    title = world.metadata.get("name", map_file.stem)
    with naming(plan_file or map_file, PlanError):
        drawing = maps.render(world, view, plan=actions, title=title, key=True)
    write_whole(output, drawing)


@first_response.command()
@click.argument("map_files", metavar="MAP...", nargs=-1, required=True, type=INPUT_FILE)
@click.option(
    "--num", type=click.IntRange(min=1), help="Number of traces, spread over the maps. Default: one a map."
)
@semantics_option
@way_option
@participant_options
def simulate(
    map_files: tuple[Path, ...],
    num: int | None,
    semantics: maps.Semantics,
    way: str,
    family: str,
    families: Path | None,
    seed: int,
    output: Path,
) -> None:
    """Let simulated participants play the MAPs with a robot and label its steps.

    Simulated participants are test instruments: what they say is no evidence about people.
    """
    who = find_family(family, families)
    problems = [maps.encode(maps.read_map(path), semantics) for path in map_files]
    play_and_write(problems, who, output, num_traces=num or len(problems), seed=seed, way=way)

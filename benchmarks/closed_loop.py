"""Robot and simulated participant in closed loop: the strategies side by side, latency, and rate.

Run ``python benchmarks/closed_loop.py``; it keeps one JSON line a game in benchmarks/records/closed-loop, a
file for each experiment, and makes docs/closed-loop.md of them. With ``--only NAME`` the other records stay
as they are, with ``--page-only`` all do. Times are CPU seconds of one core, but for the rate's planning
times, which are by the clock. The labeller learns from 34 simulated traces of the built-in training maps, all
of the family *myopic*; the maps of the games have seeds of their own.
"""

import itertools
import json
import lzma
import os
import platform
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

import click
import numpy as np

from explicable.evaluation.statistics import Counts, Estimate, estimate, estimate_ratio
from explicable.evaluation.strategies import play, strategies
from explicable.execution import Ending, Run, SimulatedPerson, builtin_families, prepare, simulate_study
from explicable.first_response import builtin_maps, encode, generate
from explicable.labelling import Labeller
from explicable.model.files import write_whole

ROOT = Path(__file__).parents[1]
RECORDS = ROOT / "benchmarks" / "records" / "closed-loop"
NUM_PARTICIPANTS = 20
"""Of each family; they take turns on the maps."""
RATE = "games a second"
RATE_NEW = "games a second, new maps"
NUM_WARM = 100
FAMILIES = ("myopic", "mission", "boltzmann")


@dataclass(frozen=True, slots=True)
class Game:
    """What came out of one game."""

    experiment: str
    strategy: str
    family: str
    map: int
    participant: int
    ending: str
    steps: int
    robot_steps: int
    inexplicable: int
    deviations: int
    changes: int
    plans_s: tuple[float, ...]
    total_s: float
    wall_s: float = 0.0  # measured where a rate is, like what follows
    setup_s: float = 0.0  # CPU time to prepare the map, with its first game


@dataclass(frozen=True, slots=True)
class Experiment:
    """Games on generated maps."""

    name: str
    side: int
    marks: int
    semantics: str
    maps: range
    families: tuple[str, ...]
    strategies: tuple[str, ...]


def experiments(num_maps: int, num_games: int, num_large: int) -> Iterator[Experiment]:
    """All of them."""
    compared = ("follower", "nearest", "ff", "explicable", "learning", "oracle")
    for semantics in ("persistent", "exclusive"):
        seeds = range(70_000, 70_000 + num_maps)
        yield Experiment(f"strategies, {semantics}", 6, 4, semantics, seeds, FAMILIES, compared)
    seeds = range(80_000, 80_000 + (num_games + 2) // 3)
    yield Experiment("replanning, 6x6", 6, 4, "persistent", seeds, FAMILIES, ("explicable",))
    seeds = range(90_000, 90_000 + (num_large + 2) // 3)
    yield Experiment("replanning, 30x30", 30, 8, "persistent", seeds, FAMILIES, ("explicable",))


def games(experiment: Experiment, labeller: Labeller) -> Iterator[Game]:
    """Play; every strategy meets the same participants with the same chance; no robot knows its map."""
    families = builtin_families()
    for seed in experiment.maps:
        world = generate(
            np.random.default_rng(seed),
            height=experiment.side,
            width=experiment.side,
            num_marks=experiment.marks,
        )
        setting = prepare(encode(world, experiment.semantics))
        for family in experiment.families:
            number = seed % NUM_PARTICIPANTS
            participant = families[family].draw(number, np.random.default_rng((1, number)))
            made = strategies(labeller)
            for name in experiment.strategies:
                person = SimulatedPerson(setting, participant, np.random.default_rng((2, seed)))
                began = time.process_time()
                played = play(made[name], setting, person, clock=time.process_time)
                total_s = time.process_time() - began
                yield _game(experiment.name, name, family, seed, number, played, total_s)


def _game(
    experiment: str,
    strategy: str,
    family: str,
    seed: int,
    number: int,
    played: Run,
    total_s: float,
    wall_s: float = 0.0,
    setup_s: float = 0.0,
) -> Game:
    labels = [step.label for step in played.episode.trace.steps if step.label is not None]
    return Game(
        experiment,
        strategy,
        family,
        seed,
        number,
        played.episode.ending.value,
        len(played.episode.trace.steps),
        len(labels),
        labels.count(False),
        played.num_deviations,
        played.num_changes,
        tuple(round(plan_s, 6) for plan_s in played.planning_s),
        round(total_s, 6),
        round(wall_s, 6),
        round(setup_s, 6),
    )


def rate(num_games: int, name: str, labeller: Labeller) -> Iterator[Game]:
    """Play again and again on one map: what a game takes, the robot's planning included."""
    setting = prepare(encode(generate(np.random.default_rng(60_001)), "exclusive"))
    strategy = strategies(labeller)[name]
    myopic = builtin_families()["myopic"]
    for seed in range(num_games):
        number = seed % NUM_PARTICIPANTS
        participant = myopic.draw(number, np.random.default_rng((1, number)))
        person = SimulatedPerson(setting, participant, np.random.default_rng((2, seed)))
        clock, processor = time.perf_counter(), time.process_time()
        played = play(strategy, setting, person)
        taken = time.process_time() - processor, time.perf_counter() - clock
        yield _game(RATE, name, "myopic", 60_001, number, played, *taken)


def rate_new(num_maps: int, name: str, labeller: Labeller) -> Iterator[Game]:
    """Play thrice on each map that a robot has never seen."""
    families = builtin_families()
    for seed in range(61_000, 61_000 + num_maps):
        world = generate(np.random.default_rng(seed))
        number = seed % NUM_PARTICIPANTS
        began = time.process_time()
        setting = prepare(encode(world, "exclusive"))
        strategy = strategies(labeller)[name]
        setup_s = time.process_time() - began
        for family in FAMILIES:
            participant = families[family].draw(number, np.random.default_rng((1, number)))
            person = SimulatedPerson(setting, participant, np.random.default_rng((2, seed)))
            clock, processor = time.perf_counter(), time.process_time()
            played = play(strategy, setting, person)
            taken = time.process_time() - processor, time.perf_counter() - clock
            yield _game(RATE_NEW, name, family, seed, number, played, *taken, setup_s)
            setup_s = 0.0


def _traces(semantics: str) -> list:
    training = [encode(world, semantics) for world in builtin_maps("training").values()]
    return [
        episode.trace
        for episode in simulate_study(
            training, builtin_families()["myopic"], num_traces=34, seed=0, way="commanded"
        )
    ]


def read(folder: Path) -> tuple[list[dict], list[Game]]:
    """Read headers and games of all experiments."""
    headers, found = [], []
    for path in sorted(folder.glob("*.jsonl.xz")):
        with lzma.open(path, "rt", encoding="utf-8") as file:
            header, *lines = map(json.loads, file)
        headers.append(header)
        found += [Game(**{**line, "plans_s": tuple(line["plans_s"])}) for line in lines]
    return headers, found


def write(folder: Path, name: str, played: Iterator[Game]) -> None:
    """Write the games of one experiment as they end; the file takes its name after the last."""
    header = {
        "experiment": name,
        "when": datetime.now(UTC).isoformat(timespec="minutes"),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}",
        "load": os.getloadavg()[0],
    }
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name.replace(', ', '-')}.jsonl.xz"
    aside = path.with_suffix(".part")
    with lzma.open(aside, "wt", encoding="utf-8") as file:
        for line in itertools.chain([header], map(asdict, played)):  # each as soon as it is there
            file.write(json.dumps(line) + "\n")
    aside.replace(path)
    click.echo(name, err=True)


def page(headers: list[dict], found: list[Game]) -> Iterator[str]:
    """Make the page."""
    yield "# Closed loop: robot and simulated participants\n"
    yield "Made by `python benchmarks/closed_loop.py` from recorded games; don't edit by hand."
    yield "Nobody here is a person: participants are simulated, and what they find inexplicable is what their"
    yield "rule says. The labeller learnt from 34 traces of simulated *myopic* participants on other maps."
    yield "Times are CPU seconds of one core."
    yield "Records: [benchmarks/records/closed-loop](../benchmarks/records/closed-loop).\n"
    yield _row("experiment", "played", "machine", "load")
    yield _row("---", "---", "---", "---:")
    for header in headers:
        yield _row(header["experiment"], header["when"], header["machine"], f"{header['load']:.1f}")
    for experiment in dict.fromkeys(game.experiment for game in found):
        rows = [game for game in found if game.experiment == experiment]
        if experiment.startswith("strategies"):
            yield from _strategies_table(experiment, rows)
    yield from _latency(found)
    yield ""
    yield (Path(__file__).parent / "closed_loop_notes.md").read_text().rstrip()


def _strategies_table(experiment: str, rows: list[Game]) -> Iterator[str]:
    maps, families = {game.map for game in rows}, sorted({game.family for game in rows})
    yield f"\n## {experiment.capitalize()} commands\n"
    yield f"{len(maps)} maps of 6x6 cells with 4 marks (seeds {min(maps)} to {max(maps)}),"
    yield f"{NUM_PARTICIPANTS} participants of each family ({', '.join(families)}); means a game with 95 %"
    yield "intervals, bootstrap over maps and participants. Team time is counted in steps.\n"
    yield _row(
        "strategy",
        "games",
        "goal reached",
        "inexplicable robot steps",
        "deviations",
        "changed requests",
        "team time",
        "replans",
        "ms a plan",
    )
    yield _row("---", *["---:"] * 8)
    for name in dict.fromkeys(game.strategy for game in rows):
        mine = [game for game in rows if game.strategy == name]
        reached = sum(game.ending == Ending.REACHED.value for game in mine)
        figures = [
            _show(estimate(_counts(mine, what)))
            for what in ("inexplicable", "deviations", "changes", "steps")
        ]
        replans = sum(len(game.plans_s) - 1 for game in mine) / len(mine)
        plan_ms = 1000 * sum(sum(game.plans_s) for game in mine) / sum(len(game.plans_s) for game in mine)
        yield _row(name, len(mine), reached, *figures, f"{replans:.2f}", f"{plan_ms:.1f}")
    yield "\nRatios to FF under replanning:\n"
    yield _row("strategy", "family", "inexplicable steps", "deviations", "team time")
    yield _row("---", "---", *["---:"] * 3)
    for name in ("explicable", "learning", "oracle"):
        for family in ("all", *families):
            ours, ffs = (
                [g for g in rows if g.strategy == strategy and family in ("all", g.family)]
                for strategy in (name, "ff")
            )
            ratios = [
                _show(estimate_ratio(_counts(ours, what), _counts(ffs, what)))
                for what in ("inexplicable", "deviations", "steps")
            ]
            yield _row(name, family, *ratios)


def _row(*cells: object) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def _counts(rows: list[Game], what: str) -> Counts:
    return Counts(
        [getattr(game, what) for game in rows],
        [1.0] * len(rows),
        [game.map for game in rows],
        [f"{game.family}-{game.participant}" for game in rows],
    )


def _show(found: Estimate) -> str:
    return f"{found.value:.2f} [{found.low:.2f}, {found.high:.2f}]"


def _latency(found: list[Game]) -> Iterator[str]:
    yield "\n## Latency and rate\n"
    yield _row("what", "games", "replans", "median ms", "99th percentile ms", "most ms", "to reach")
    yield _row("---", *["---:"] * 6)
    for name, aim in (("replanning, 6x6", 20), ("replanning, 30x30", 200)):
        rows = [game for game in found if game.experiment == name]
        replans = np.array([s for game in rows for s in game.plans_s[1:]]) * 1000
        if replans.size:
            figures = np.quantile(replans, [0.5, 0.99, 1.0])
            verdict = "reached" if figures[1] <= aim else "**missed**"
            shown = [f"{figure:.1f}" for figure in figures]
            yield _row(name, len(rows), replans.size, *shown, f"{aim} at the 99th: {verdict}")
    for experiment, num_warm in ((RATE, NUM_WARM), (RATE_NEW, 0)):
        if rates := [game for game in found if game.experiment == experiment]:
            yield from _rate_table(experiment, rates, num_warm)


def _rate_table(experiment: str, rates: list[Game], num_warm: int) -> Iterator[str]:
    if experiment == RATE:
        yield "\nGames a second of one core on one 6x6 map, planning included, without rendering. The same"
        yield f"robot plays again and again, so it remembers plans; {num_warm} games before don't count, nor"
        yield "does what is made for the map (to reach: 200):\n"
    else:
        yield f"\nThe same on {len({game.map for game in rates})} maps that the robot has never seen, each"
        yield "played thrice (one participant of each family). What planners make for a map counts as"
        yield "planning; grounding the map for play itself counts in the last column alone:\n"
    columns = (
        "games",
        "games a second of CPU time",
        "by the clock",
        "without planning",
        "",
        "with the map's grounding",
    )
    yield _row("strategy", *columns)
    yield _row("---", *["---:"] * 4, "---", "---:")
    for name in dict.fromkeys(game.strategy for game in rates):
        counted = [game for game in rates if game.strategy == name][num_warm:]
        whole, wall = (
            len(counted) / sum(getattr(game, what) for game in counted) for what in ("total_s", "wall_s")
        )
        rest = len(counted) / sum(game.wall_s - sum(game.plans_s) for game in counted)
        verdict = "reached" if whole >= 200 else "**missed**"
        grounded = len(counted) / sum(game.total_s + game.setup_s for game in counted)
        yield _row(
            name, len(counted), f"{whole:.0f}", f"{wall:.0f}", f"{rest:.0f}", verdict, f"{grounded:.0f}"
        )


@click.command()
@click.option("--maps", default=200, show_default=True, help="Maps on which strategies are compared.")
@click.option(
    "--games", "num_games", default=1000, show_default=True, help="Games for the latency on 6x6 maps."
)
@click.option("--large", default=1000, show_default=True, help="Games for the latency on 30x30 maps.")
@click.option("--only", multiple=True, metavar="NAME", help="Play this experiment alone; may be repeated.")
@click.option("--page-only", is_flag=True, help="Only make the page of the records.")
def main(maps: int, num_games: int, large: int, only: tuple[str, ...], page_only: bool) -> None:
    """Play all games, keep the records, make the page."""
    if not page_only:
        for experiment in experiments(maps, num_games, large):
            if not only or experiment.name in only:
                labeller = Labeller.train(_traces(experiment.semantics), num_bootstrap=0)
                write(RECORDS, experiment.name, games(experiment, labeller))
        if not only or {RATE, RATE_NEW}.intersection(only):
            labeller = Labeller.train(_traces("exclusive"), num_bootstrap=0)
            names = list(strategies(labeller))
            if not only or RATE in only:
                write(RECORDS, RATE, (g for name in names for g in rate(500 + NUM_WARM, name, labeller)))
            if not only or RATE_NEW in only:
                write(RECORDS, RATE_NEW, (g for name in names for g in rate_new(100, name, labeller)))
    headers, found = read(RECORDS)
    names = {RATE, RATE_NEW, *(experiment.name for experiment in experiments(maps, num_games, large))}
    if lacking := names - {header["experiment"] for header in headers}:
        raise click.ClickException(
            f"the page is not made: there are no records of {'; '.join(sorted(lacking))}"
        )
    write_whole(ROOT / "docs" / "closed-loop.md", "\n".join(page(headers, found)) + "\n")


if __name__ == "__main__":
    main()

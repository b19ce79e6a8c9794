"""The paper's experiment in small: train on labelled traces, then compare three plans for each test map.

`run_demo` computes, `write_demo` writes. Tables and page are made from the records, which are written too:
whoever recomputes the scores from the files gets the same numbers.
"""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from explicable.errors import UsageError
from explicable.evaluation.best_plan import plan_best
from explicable.evaluation.report import PlanPanel, Ratio, Report, Scenario, write_report
from explicable.execution import builtin_families, prepare, simulate, simulate_study
from explicable.first_response import World, builtin_maps, encode, format_map, key_entries, render
from explicable.labelling import LabelledPlan, Labeller, Trace, problem_texts, write_traces
from explicable.model.files import write_whole
from explicable.model.grounding import ground_team
from explicable.model.plan import format_action, parse_plan
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamTask
from explicable.planning import plan_classically

NUM_TRACES = 34
"""Traces in the paper's training set."""

FAMILY = "myopic"
"""Family of the simulated participants."""

PLAN_TITLES = {"ff": "FF plan", "explicable": "Explicable plan", "participants": "Participant's plan"}
"""The paper's three types of plan, in the order of its tables."""

NUM_PARTS = 6
"""Parts of the work that `run_demo` tells about: simulating, training, and four maps."""

Tell = Callable[[str], None]
"""Called with a word on each part of the work before it begins."""


@dataclass(frozen=True, slots=True)
class Record:
    """One plan for one map, and what the labeller says of it: a line of ``records.jsonl``.

    ``num_steps`` is the denominator of ``f_paper`` and ``f_expected``, ``num_robot_steps`` that of
    ``f_robot``. ``labels`` and ``probabilities`` belong to the steps; human steps are explicable by
    definition.
    """

    map: str
    plan_type: str
    plan: tuple[str, ...]
    cost: int
    labels: tuple[bool, ...]
    probabilities: tuple[float, ...]
    num_steps: int
    num_robot_steps: int
    f_paper: float
    f_robot: float
    f_expected: float


@dataclass(frozen=True, slots=True)
class Demo:
    """All that the demo computed."""

    seed: int
    simulated: bool
    maps: dict[str, World]
    traces: tuple[Trace, ...]
    labeller: Labeller
    records: tuple[Record, ...]


def run_demo(seed: int = 0, *, traces: Sequence[Trace] | None = None, tell: Tell | None = None) -> Demo:
    """Train on 34 labelled traces of the training maps, and plan for the test maps.

    Parameters
    ----------
    seed
        Seed of all chance.
    traces
        Labelled traces, of people for example; by default simulated participants make them.
    tell
        Is told about each part of the work.
    """
    tell = tell or (lambda _: None)
    if traces is None:
        tell(f"simulated participants label {NUM_TRACES} plans")
        training = [encode(world) for world in builtin_maps("training").values()]
        family = builtin_families()[FAMILY]
        episodes = simulate_study(training, family, num_traces=NUM_TRACES, seed=seed, way="mixed")
        chosen = tuple(episode.trace for episode in episodes)
    else:
        chosen = tuple(traces)
    tell(f"training on {len(chosen)} traces")
    labeller = Labeller.train(chosen, seed=seed)
    maps = builtin_maps("test")
    records: list[Record] = []
    for number, (name, world) in enumerate(maps.items()):
        tell(f"planning for {name}")
        records += _compare(name, world, labeller, np.random.default_rng((seed, number)))
    return Demo(seed, traces is None, maps, chosen, labeller, tuple(records))


def _compare(name: str, world: World, labeller: Labeller, rng: np.random.Generator) -> Iterator[Record]:
    """Make the three plans for a map."""
    problem = encode(world)
    team_task = ground_team(problem)
    for plan_type, team_plan in (
        ("ff", plan_classically(team_task, algorithm="ff")),
        ("explicable", plan_best(team_task, labeller)),
    ):
        if team_plan.plan is None:
            raise UsageError(f"no plan for {name}: {team_plan.outcome}")
        yield _record(name, plan_type, team_task, team_plan.plan.actions, labeller)
    participant = builtin_families()[FAMILY].draw(0, rng)
    played = simulate(prepare(problem), participant, rng).trace.actions
    yield _record(name, "participants", team_task, played, labeller)


def _record(
    name: str, plan_type: str, team_task: TeamTask, actions: Sequence[GroundAtom], labeller: Labeller
) -> Record:
    labelled: LabelledPlan = labeller.label(team_task, actions)
    scores = labelled.scores
    return Record(
        map=name,
        plan_type=plan_type,
        plan=tuple(map(format_action, actions)),
        cost=team_task.task.execute(actions).cost,
        labels=tuple(labelled.labels),
        probabilities=tuple(labelled.probabilities),
        num_steps=scores.paper.num_steps,
        num_robot_steps=scores.robot.num_steps,
        f_paper=scores.f_paper or 0.0,
        f_robot=scores.f_robot or 0.0,
        f_expected=scores.f_expected or 0.0,
    )


def pool(records: Sequence[Record], plan_type: str) -> Ratio:
    """Pool one type of plan over all maps: ratios of sums (Table 1 of the paper)."""
    rows = [record for record in records if record.plan_type == plan_type]
    steps = sum(record.num_steps for record in rows)
    robot_steps = sum(record.num_robot_steps for record in rows)
    return Ratio(
        kind=plan_type,
        title=PLAN_TITLES[plan_type],
        num_steps=steps,
        f_paper=sum(record.f_paper * record.num_steps for record in rows) / steps,
        f_robot=sum(record.f_robot * record.num_robot_steps for record in rows) / robot_steps,
        f_expected=sum(record.f_expected * record.num_steps for record in rows) / steps,
    )


def make_report(demo: Demo) -> Report:
    """Lay the demo out as a page."""
    origin = "simulated participants, who are test instruments and no people" if demo.simulated else "a file"
    return Report(
        title="Plans that a teammate expects",
        summary="The paper's comparison on four maps: what a classical planner plans, what is planned with"
        " regard to the person, and how a simulated participant played.",
        settings={
            "seed": str(demo.seed),
            "traces": f"{len(demo.traces)}, from {origin}",
            "commands": "persistent",
            "test maps": ", ".join(demo.maps),
        },
        ratios=tuple(pool(demo.records, plan_type) for plan_type in PLAN_TITLES),
        scenarios=tuple(
            Scenario(name, tuple(_panel(demo, record) for record in demo.records if record.map == name))
            for name in demo.maps
        ),
        key=key_entries("robot"),
        notes=(
            "Labels are what the labeller predicts, as in the paper; people's own judgement may differ.",
            "In F_paper human steps count as explicable by definition; F_robot counts the robot's steps only;"
            " E[F] is the expectation under the labeller, all steps counted.",
            "The paper's figures come from other maps, and from people.",
        ),
    )


def _panel(demo: Demo, record: Record) -> PlanPanel:
    return PlanPanel(
        kind=record.plan_type,
        title=PLAN_TITLES[record.plan_type],
        svg=draw(demo, record),
        num_steps=record.num_steps,
        f_paper=record.f_paper,
        f_robot=record.f_robot,
        f_expected=record.f_expected,
    )


def draw(demo: Demo, record: Record, title: str | None = None) -> str:
    """Draw one plan on its map, as the robot sees it; inexplicable steps are coloured."""
    actions = parse_plan("\n".join(record.plan))
    world = demo.maps[record.map]
    return render(world, "robot", actions, record.labels, record.probabilities, title)


def write_demo(demo: Demo, folder: Path) -> None:
    """Write traces, labeller, maps, problems, plans, figures, records and, last, ``report.html``."""
    write_traces(folder / "traces.jsonl", demo.traces)
    demo.labeller.save(folder / "labeller.json")
    for name, world in demo.maps.items():
        write_whole(folder / "maps" / f"{name}.map", format_map(world))
        for part, text in problem_texts(encode(world)).items():
            write_whole(folder / "problems" / name / f"{part.replace('_', '-')}.pddl", text)
    for record in demo.records:
        actions = "\n".join(record.plan)
        write_whole(
            folder / "plans" / f"{record.map}.{record.plan_type}.plan", f"{actions}\n; cost = {record.cost}\n"
        )
        write_whole(folder / "figures" / f"{record.map}.{record.plan_type}.svg", draw(demo, record))
    lines = "".join(json.dumps(asdict(record)) + "\n" for record in demo.records)
    write_whole(folder / "records.jsonl", lines)
    write_report(folder / "report.html", make_report(demo))

"""Ask how many people would tell explicable plans from FF's on the paper's kind of test maps.

    python benchmarks/study_power.py

Trains a labeller on a simulated study of the 16 training maps, puts plans of FF and of the explicable planner
for the 4 test maps into a study of replays (each person watches 4 of the 8), and asks ``explicable study
power``. Keeps its answer in ``benchmarks/records/study_power.json``. Simulated participants are test
instruments: the figures say nothing about people.
"""

import contextlib
import io
import json
import tempfile
from pathlib import Path

from explicable.cli import run
from explicable.first_response import builtin_maps, format_map

RECORD = Path(__file__).parent / "records" / "study_power.json"
STUDY = 'title = "Replays"\npractice = "test-01.map"\ntasks_each = 4\n'
TASK = """
[[task]]
name = "{name}-{source}"
map = "{name}.map"
plan = "{name}-{source}.txt"
source = "{source}"
"""


def explicable(*arguments: object) -> str:
    """Run a command; return what it printed."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        code = run([str(argument) for argument in arguments])
    if code:
        raise SystemExit(code)
    return printed.getvalue()


def make_study(folder: Path) -> None:
    """Plan for the test maps, and write the study."""
    training = builtin_maps("training")
    for name, world in {**training, **builtin_maps("test")}.items():
        (folder / f"{name}.map").write_text(format_map(world))
    maps = [folder / f"{name}.map" for name in training]
    options = ["--num", 34, "--semantics", "exclusive", "-o", folder / "traces.jsonl"]
    explicable("first-response", "simulate", *maps, *options)
    explicable("train", folder / "traces.jsonl", "-o", folder / "labeller.json", "--bootstrap", 0)
    tasks = []
    for name in builtin_maps("test"):
        pddl = folder / name
        explicable("first-response", "encode", folder / f"{name}.map", "-o", pddl, "--semantics", "exclusive")
        files = [pddl / "domain.pddl", pddl / "problem.pddl", "--human-domain", pddl / "human-domain.pddl"]
        files += ["--human-problem", pddl / "human-problem.pddl"]
        explicable("plan", *files, "-o", folder / f"{name}-ff.txt")
        labeller = ["--labeller", folder / "labeller.json", "--time-limit", 10]
        explicable("plan", *files, *labeller, "-o", folder / f"{name}-explicable.txt")
        tasks += [TASK.format(name=name, source=source) for source in ("ff", "explicable")]
    (folder / "study.toml").write_text(STUDY + "".join(tasks))


def main() -> None:
    """Make the study, ask, and keep the answer."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_study(folder)
        compared = ["--compare", "explicable", "ff", "--most", 200, "--json"]
        told = json.loads(explicable("study", "power", folder, *compared))
    RECORD.write_text(json.dumps(told, indent=1) + "\n")
    print(told["answer"])


main()

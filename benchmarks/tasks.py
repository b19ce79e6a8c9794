"""The tasks that benchmarks run on: any folder of PDDL files, or generated ones."""

from dataclasses import dataclass
from pathlib import Path

import generate

# Those for which rates, and times of grounding, have targets; names as in the usual collection of tasks.
RATE_TASKS = (
    "gripper/prob20",
    "blocks/probBLOCKS-11-1",
    "depot/p07",
    "satellite/p15-pfile15",
    "rovers/p20",
    "miconic/s30-0",
    "zenotravel/p14",
    "zenotravel/p20",
)
GROUNDING_TASKS = ("zenotravel/p20", "rovers/p30")

# On these, on maps and on a generated logistics task, search with a labeller is compared with search without.
LABELLED_TASKS = (
    "rovers/p20",
    "logistics00/probLOGISTICS-15-1",
    "logistics98/prob05",
    "depot/p07",
    "depot/p13",
)
LABELLED_MAPS = ((6, 4), (12, 6), (25, 8), (50, 8))

MAPS = ((6, 4), (12, 6), (25, 8), (50, 10), (100, 15), (200, 20), (200, 30))
LARGE_MAP = "map/200x200-20"


@dataclass(frozen=True, slots=True)
class BenchmarkTask:
    """A domain file and a problem file; the name is `domain/problem`."""

    name: str
    domain: Path
    problem: Path


def read_folder(folder: Path) -> list[BenchmarkTask]:
    """Find all problems `x.pddl` below `folder`: beside `domain.pddl`, `domain_x.pddl` or `x-domain.pddl`."""
    tasks = []
    for problem in sorted(folder.rglob("*.pddl")):
        beside = problem.parent
        own = (
            beside / f"domain_{problem.name}",
            beside / f"{problem.stem}-domain.pddl",
            beside / "domain.pddl",
        )
        domain = next((path for path in own if path.is_file()), None)
        if domain and not problem.stem.startswith("domain") and not problem.stem.endswith("domain"):
            tasks.append(BenchmarkTask(f"{beside.name}/{problem.stem}", domain, problem))
    return tasks


def small(folder: Path) -> BenchmarkTask:
    """Make a task for which every planner should find a plan at once."""
    return _written(folder, "gripper/2", generate.gripper(2))


def mixed(folder: Path) -> list[BenchmarkTask]:
    """Make a mixed set for runs without a folder of tasks."""
    tasks = {f"gripper/{n}": generate.gripper(n) for n in (10, 30)}
    tasks |= {f"blocks/{n}": generate.blocks(n, seed=1) for n in (8, 15, 30)}
    tasks |= {f"logistics/{n}": generate.logistics(n, 4, 3 * n, seed=1) for n in (3, 6, 10)}
    tasks |= {_map_name(size, marks): generate.grid(size, size, marks) for size, marks in MAPS[:4]}
    return [_written(folder, name, texts) for name, texts in tasks.items()]


def growing(folder: Path) -> list[BenchmarkTask]:
    """Make tasks of growing size."""
    tasks = {_map_name(size, marks): generate.grid(size, size, marks) for size, marks in MAPS}
    tasks |= {f"gripper/{n}": generate.gripper(n) for n in (10, 40, 160, 640)}
    tasks |= {f"logistics/{n}": generate.logistics(n, 5, 5 * n, seed=1) for n in (2, 5, 10, 20)}
    return [_written(folder, name, texts) for name, texts in tasks.items()]


def with_labels(folder: Path, tasks: list[BenchmarkTask]) -> list[BenchmarkTask]:
    """Choose and make the tasks that are searched with a labeller."""
    made = {_map_name(size, marks): generate.grid(size, size, marks) for size, marks in LABELLED_MAPS}
    made["logistics/6"] = generate.logistics(6, 4, 18, seed=1)
    return [
        *(_written(folder, name, texts) for name, texts in made.items()),
        *(task for task in tasks if task.name in LABELLED_TASKS),
    ]


def _map_name(size: int, marks: int) -> str:
    return f"map/{size}x{size}-{marks}"


def _written(folder: Path, name: str, texts: tuple[str, str]) -> BenchmarkTask:
    place = folder / name
    place.mkdir(parents=True, exist_ok=True)
    paths = place / "domain.pddl", place / "problem.pddl"
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text)
    return BenchmarkTask(name, *paths)

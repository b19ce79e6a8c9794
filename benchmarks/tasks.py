"""The tasks that benchmarks run on: any folder of PDDL files, or generated ones."""

from dataclasses import dataclass
from pathlib import Path

from explicable.first_response.encoding import encode
from explicable.first_response.generator import generate
from explicable.pddl import format_domain, format_problem

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

MAPS = ((6, 4), (12, 6), (25, 8), (50, 10), (100, 15), (200, 20), (200, 30))
LARGE_MAP = "map/200x200-20"


@dataclass(frozen=True, slots=True)
class BenchmarkTask:
    """A domain file and a problem file; the name is `domain/problem`."""

    name: str
    domain: Path
    problem: Path


def read_folder(folder: Path) -> list[BenchmarkTask]:
    """Find all problems `x.pddl` below `folder`, each beside `domain.pddl`, `domain_x.pddl` or `x-domain.pddl`."""
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


def maps(folder: Path, seed: int = 0) -> list[BenchmarkTask]:
    """Make first-response maps of growing size, as the joint problem that the robot plans for."""
    import numpy as np

    tasks = []
    for size, marks in MAPS:
        world = generate(np.random.default_rng(seed), height=size, width=size, num_marks=marks)
        problem = encode(world).composite
        texts = (format_domain(problem.domain), format_problem(problem))
        tasks.append(_written(folder, f"map/{size}x{size}-{marks}", *texts))
    return tasks


def small(folder: Path) -> BenchmarkTask:
    """Make a task for which every planner should find a plan at once."""
    return _gripper(folder, 2)


def growing(folder: Path) -> list[BenchmarkTask]:
    """Make tasks of growing size."""
    return [*maps(folder), *(_gripper(folder, balls) for balls in (10, 30, 100, 300))]


def generated(folder: Path) -> list[BenchmarkTask]:
    """Make a mixed set for runs without a folder."""
    return [*maps(folder)[:4], *(_gripper(folder, balls) for balls in (4, 10, 20))]


GRIPPER = """(define (domain gripper) (:requirements :strips :typing) (:types room ball gripper)
(:predicates (at-robby ?r - room) (at ?b - ball ?r - room) (free ?g - gripper) (carry ?b - ball ?g - gripper))
(:action move :parameters (?from ?to - room) :precondition (at-robby ?from)
  :effect (and (at-robby ?to) (not (at-robby ?from))))
(:action pick :parameters (?b - ball ?r - room ?g - gripper)
  :precondition (and (at ?b ?r) (at-robby ?r) (free ?g))
  :effect (and (carry ?b ?g) (not (at ?b ?r)) (not (free ?g))))
(:action drop :parameters (?b - ball ?r - room ?g - gripper) :precondition (and (carry ?b ?g) (at-robby ?r))
  :effect (and (at ?b ?r) (free ?g) (not (carry ?b ?g)))))
"""


def _gripper(folder: Path, num_balls: int) -> BenchmarkTask:
    balls = [f"ball{i}" for i in range(num_balls)]
    here, there = (" ".join(f"(at {ball} {room})" for ball in balls) for room in ("a", "b"))
    text = f"""(define (problem gripper-{num_balls}) (:domain gripper)
(:objects a b - room left right - gripper {" ".join(balls)} - ball)
(:init (at-robby a) (free left) (free right) {here}) (:goal (and {there})))"""
    return _written(folder, f"gripper/{num_balls}", GRIPPER, text)


def _written(folder: Path, name: str, domain: str, problem: str) -> BenchmarkTask:
    place = folder / name
    place.mkdir(parents=True, exist_ok=True)
    (place / "domain.pddl").write_text(domain)
    (place / "problem.pddl").write_text(problem)
    return BenchmarkTask(name, place / "domain.pddl", place / "problem.pddl")

"""Benchmark tasks made from a seed: well-formed, solvable as far as relaxation tells, repeatable."""

import runpy
from pathlib import Path

import pytest

from explicable.model.grounding import ground
from explicable.pddl import parse_domain, parse_problem

GENERATE = runpy.run_path(str(Path(__file__).parents[1] / "benchmarks" / "generate.py"))


@pytest.mark.parametrize(
    ("kind", "size", "num_operators"),
    [
        ("gripper", (5,), 2 * 2 + 5 * 2 * 2 * 2),
        ("blocks", (6,), 2 * 6 + 2 * 6 * 6),
        ("logistics", (3, 2, 4), None),
        ("grid", (8, 6, 3), None),
    ],
)
def test_tasks_are_read_and_grounded(kind, size, num_operators):
    warnings = []
    domain_text, problem_text = GENERATE[kind](*size)
    assert GENERATE[kind](*size) == (domain_text, problem_text)
    domain = parse_domain(domain_text, warn=warnings.append)
    task = ground(parse_problem(problem_text, domain, warn=warnings.append))
    assert not warnings
    assert task.goal_reachable
    assert num_operators in {None, task.num_operators}


def test_seeds_make_different_tasks():
    assert GENERATE["blocks"](8, seed=1) != GENERATE["blocks"](8, seed=2)

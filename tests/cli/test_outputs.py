"""Where commands write: what cannot be is said before the work, not after it."""

import subprocess
import sys

import pytest

DOMAIN = "(define (domain lamp) (:predicates (on) (off)) (:action press :effect (on)))"
HOPELESS = "(define (problem never) (:domain lamp) (:init) (:goal (off)))"
USAGE, UNSOLVABLE = 2, 4


@pytest.fixture
def plan(tmp_path):
    """Ask for a plan that does not exist, so that the exit code tells whether it was looked for."""
    (tmp_path / "domain.pddl").write_text(DOMAIN)
    (tmp_path / "problem.pddl").write_text(HOPELESS)

    def plan(output):
        command = [sys.executable, "-m", "explicable", "plan", "domain.pddl", "problem.pddl", "-o", output]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)

    return plan


@pytest.mark.parametrize("output", ["domain.pddl/plan", "domain.pddl/deep/down/plan"])
def test_a_file_is_no_folder(plan, tmp_path, output):
    done = plan(output)
    assert done.returncode == USAGE
    assert done.stderr.splitlines()[-1] == (
        f"Error: Invalid value for '-o' / '--output': '{output}' would lie in '{tmp_path / 'domain.pddl'}',"
        " which is no directory"
    )


@pytest.mark.parametrize(
    "output", ["plan", "new/folder/plan", "problem.pddl", "/dev/null", "link", "dangling"]
)
def test_what_can_be_written_is_let_through(plan, tmp_path, output):
    (tmp_path / "link").symlink_to("domain.pddl")
    (tmp_path / "dangling").symlink_to("nowhere/yet")
    assert plan(output).returncode == UNSOLVABLE


def test_a_device_is_no_folder(tmp_path):
    (tmp_path / "room.map").write_text("@.*")
    command = [sys.executable, "-m", "explicable", "first-response", "encode", "room.map", "-o", "/dev/full"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == USAGE
    assert done.stderr.splitlines()[-1] == (
        "Error: Invalid value for '-o' / '--output': '/dev/full' is no directory"
    )

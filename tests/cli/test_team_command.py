"""`explicable team` as a user types it."""

import json
import subprocess
import sys
from pathlib import Path

ROVERS = Path(__file__).parents[2] / "examples" / "rover-survey"
FILES = [ROVERS / "domain.pddl", ROVERS / "problem.pddl"]


def explicable(*arguments):
    done = subprocess.run(
        [sys.executable, "-m", "explicable", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert "Traceback" not in done.stderr
    return done


def test_agents_and_differences_are_listed():
    human = ["--human-domain", ROVERS / "human-domain.pddl", "--human-problem", ROVERS / "human-problem.pddl"]
    shown = explicable("team", *FILES, *human)
    assert shown.returncode == 0, shown.stderr
    assert "robot  scout: analyse, drive, send\n" in shown.stdout
    assert "  photograph needs (memory-free ?r)\n" in shown.stdout
    record = json.loads(explicable("team", *FILES, *human, "--json").stdout)
    assert record["agents"][0] == {"name": "scientist", "kind": "human", "actions": ["request"]}
    assert record["goal_reachable"] == {"robots": True, "human": True}
    assert len(record["differences"]["tellable"]) == 8
    assert record["differences"]["names"] == ["predicate memory-free is unknown to the person"]
    assert "The two models are the same." in explicable("team", *FILES).stdout


def test_all_conflicts_are_listed_and_every_other_command_names_one(tmp_path):
    (tmp_path / "h.pddl").write_text(
        "(define (problem p) (:domain rover-survey)\n"
        "(:objects mesa - rock\nshale - view) (:init) (:goal (and)))"
    )
    human = ["--human-problem", tmp_path / "h.pddl"]
    listed = explicable("team", *FILES, *human)
    assert listed.returncode == 3
    mesa, shale = listed.stderr.splitlines()
    assert f"{tmp_path / 'h.pddl'}:2:11: object 'mesa' is site in the robot's model, but rock" in mesa
    assert f"{tmp_path / 'h.pddl'}:3:1: object 'shale' is rock in the robot's model, but view" in shale
    planned = explicable("plan", *FILES, *human)
    assert planned.returncode == 3
    assert planned.stderr == f"{mesa} (one of 2 conflicts: `explicable team` lists them)\n"

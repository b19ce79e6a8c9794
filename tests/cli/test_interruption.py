"""Ctrl-C: the best plan so far is the answer; at the very start the command just ends."""

import os
import pty
import signal
import subprocess
import sys
from pathlib import Path

from explicable.model.grounding import ground_team
from explicable.model.plan import parse_plan
from explicable.pddl import read_team_problem
from planning.floors import judge_of_progress

INTERRUPTED = 130
ROVERS = Path(__file__).parents[2] / "examples" / "rover-survey"
TEAM = [ROVERS / f"{name}.pddl" for name in ("domain", "problem", "human-domain", "human-problem")]


def test_ctrl_c_ends_the_improvement_with_the_best_plan_so_far(tmp_path):
    problem = read_team_problem(*TEAM)
    labeller = judge_of_progress()
    labeller.schemas = tuple(schema.name for schema in problem.robot.domain.actions)
    labeller.save(tmp_path / "labeller.json")
    human = ["--human-domain", TEAM[2], "--human-problem", TEAM[3]]
    options = ["--labeller", tmp_path / "labeller.json", "--alpha", "10", "--improve-time", "3600"]
    terminal, shown = pty.openpty()  # only a terminal is told of each better plan
    command = [sys.executable, "-m", "explicable", "plan", *TEAM[:2], *human, *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=shown, text=True) as planning:
        os.close(shown)
        said = b""
        while b"J = " not in said:  # until the improvement has begun; if the process ends, reading fails
            said += os.read(terminal, 1000)
        planning.send_signal(signal.SIGINT)
        plan, _ = planning.communicate(timeout=600)
    os.close(terminal)
    assert planning.returncode == 0
    task = ground_team(problem).task
    assert task.is_goal(task.execute(parse_plan(plan)).states[-1])


def test_ctrl_c_while_libraries_are_imported_ends_the_command_without_a_word(tmp_path):
    pressed = "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n"
    (tmp_path / "click.py").write_text(pressed)  # the first that is imported from outside
    command = [sys.executable, "-m", "explicable", "--help"]
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    done = subprocess.run(command, env=environment, capture_output=True, timeout=600, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (INTERRUPTED, b"", b"")


def test_ctrl_c_stays_ignored_where_whoever_started_the_command_ignores_it(tmp_path):
    (tmp_path / "click.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n")
    command = ["sh", "-c", 'trap "" INT; exec "$0" -m explicable --help', sys.executable]
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    done = subprocess.run(command, env=environment, capture_output=True, timeout=600, check=False)
    assert b"AttributeError" in done.stderr  # it went on, with a click that has nothing in it

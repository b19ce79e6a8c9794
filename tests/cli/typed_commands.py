"""Commands as a user types them: real processes, real files."""

import subprocess
import sys
from dataclasses import dataclass

SOLVED, USAGE, BAD_INPUT, UNSOLVABLE, LIMIT = 0, 2, 3, 4, 5
TASK = ["task/domain.pddl", "task/problem.pddl"]
HUMAN = ["--human-domain", "task/human-domain.pddl", "--human-problem", "task/human-problem.pddl"]


@dataclass(frozen=True)
class Finished:
    code: int
    out: str
    err: str


def explicable(*arguments, cwd=None):
    done = subprocess.run(
        [sys.executable, "-m", "explicable", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        timeout=600,
        check=False,
    )
    assert "Traceback" not in done.stderr
    return Finished(done.returncode, done.stdout, done.stderr)

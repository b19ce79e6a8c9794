"""Without the packages of an extra, commands that need them say so at once."""

import subprocess
import sys

import pytest

WITHOUT = """
import sys
from explicable.cli import run

sys.modules[sys.argv[1]] = None
sys.exit(run(sys.argv[2:]))
"""
"""Runs a command where a package can't be found."""


@pytest.mark.parametrize(
    ("package", "extra", "command"),
    [
        ("statsmodels", "evaluation", "evaluate --quick"),
        ("matplotlib", "evaluation", "evaluate --report-only"),
        ("matplotlib", "evaluation", "front l.json domain.pddl problem.pddl --plot front.svg"),
        ("fastapi", "study", "study status pilot"),
    ],
)
def test_a_missing_package_is_named_with_its_extra(tmp_path, package, extra, command):
    for name in ("domain.pddl", "problem.pddl", "l.json"):
        (tmp_path / name).touch()
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT, package, *command.split()],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert f"this needs {package}: pip install 'explicable[{extra}]'" in done.stderr
    assert not (tmp_path / "evaluation-quick").exists()

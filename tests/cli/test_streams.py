"""Standard streams that are closed, full, or whose reader has gone."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from explicable.first_response import encode, parse_map
from explicable.labelling import problem_texts

GENERATE = ["first-response", "generate"]


def run(arguments, cwd=None, **streams):
    command = [sys.executable, "-m", "explicable", *arguments]
    return subprocess.run(command, cwd=cwd, timeout=600, check=False, **streams)


@pytest.mark.parametrize("arguments", [["--help"], ["plan", "--help"], GENERATE], ids=" ".join)
def test_a_reader_who_has_gone_is_no_failure(arguments):
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = run(arguments, stdout=writing, stderr=subprocess.PIPE)
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (0, b"")


def test_a_full_disk_behind_standard_output_is_named():
    with Path("/dev/full").open("wb") as full:
        done = run(GENERATE, stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 3
    assert done.stderr == b"explicable: standard output: No space left on device\n"


@pytest.fixture(scope="module")
def task(tmp_path_factory):
    folder = tmp_path_factory.mktemp("task")
    for part, text in problem_texts(encode(parse_map("@.*"))).items():
        (folder / part).write_text(text)
    (folder / "plan").write_text("(command person c-0-2)\n")
    return folder


@pytest.mark.parametrize("command", ["plan", "measure"])
def test_standard_error_may_be_closed(task, command):
    arguments = [command, "domain", "problem", *(["plan"] if command == "measure" else [])]
    shell = 'exec 2>&-; exec "$0" -m explicable "$@"'
    done = subprocess.run(
        ["sh", "-c", shell, sys.executable, *arguments],
        cwd=task,
        stdout=subprocess.PIPE,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0
    assert done.stdout

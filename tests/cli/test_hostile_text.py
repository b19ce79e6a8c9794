"""Characters in files that would speak to the terminal are shown, not sent."""

import os
import pty
import subprocess
import sys
from itertools import takewhile

import pytest
from typed_commands import SOLVED, explicable

from explicable.first_response import encode, parse_map
from explicable.labelling import LabelledStep, Trace, problem_texts, write_traces

NAME = "\x1b[2j\u202eevil"  # clears the screen, and turns what follows around
SHOWN = r"\x1b[2j\u202eevil"


@pytest.fixture
def task(tmp_path):
    problem = encode(parse_map("@.*"))
    texts = problem_texts(problem)
    for part in ("domain", "problem"):
        (tmp_path / part).write_text(texts[part].replace("c-0-2", NAME))
    step = LabelledStep("person", ("command", "person", "c-0-2"))
    write_traces(tmp_path / "traces", [Trace(problem, (step,), NAME, "person")])
    (tmp_path / "plan").write_text(f"(move r1 c-0-0 {NAME})\n")
    foreign = LabelledStep(NAME, ("command", "person", "c-0-2"))
    write_traces(tmp_path / "foreign", [Trace(problem, (foreign,), "anna", "person")])
    return tmp_path


def on_terminal(*arguments, cwd):
    """Run a command whose output is a terminal; return what it wrote there."""
    terminal, shown = pty.openpty()
    with subprocess.Popen([sys.executable, "-m", "explicable", *arguments], cwd=cwd, stdout=shown) as command:
        os.close(shown)
        written = b"".join(takewhile(bool, iter(lambda: read(terminal), None)))
    os.close(terminal)
    assert command.returncode == SOLVED
    return written.decode()


def read(terminal):
    try:
        return os.read(terminal, 4096)
    except OSError:  # how Linux says that nobody holds the other end
        return b""


@pytest.mark.parametrize(
    "arguments",
    [
        ["measure", "domain", "problem", "plan"],
        ["traces", "check", "foreign"],
        ["plan", "domain", NAME],
        ["train", "traces", "-o", "labeller", "--cross-validate", NAME],
    ],
)
def test_messages_show_what_would_speak_to_a_terminal(task, arguments):
    done = explicable(*arguments, cwd=task)
    assert done.code != SOLVED
    assert SHOWN in done.err
    assert all(character.isprintable() for line in done.err.splitlines() for character in line)


@pytest.mark.parametrize(
    "arguments",
    [["plan", "domain", "problem"], ["traces", "split", "traces", "--by", "annotator", "-o", "parts"]],
)
def test_terminals_are_shown_what_would_speak_to_them(task, arguments):
    written = on_terminal(*arguments, cwd=task)
    assert SHOWN in written
    assert all(character.isprintable() for line in written.split("\r\n") for character in line)


def test_pipes_and_files_get_what_is_there(task):
    explicable("plan", "domain", "problem", "-o", "found", cwd=task)
    assert NAME in (task / "found").read_text()
    assert explicable("plan", "domain", "problem", cwd=task).out == (task / "found").read_text()
    assert explicable("measure", "domain", "problem", "found", cwd=task).code == SOLVED


def test_a_files_name_is_no_markup(tmp_path):
    settings = "num_traces = 4\nnum_maps = 1\nnum_judges = 1\nplans = ['ff']"
    text = f"question = '?'\nkind = 'plans'\n[settings]\n{settings}\n"
    (tmp_path / "odd[b].toml").write_text(text)
    shown = {"FORCE_COLOR": "1"}  # progress is for terminals
    command = [sys.executable, "-m", "explicable", "evaluate", "--study", "odd[b].toml", "-o", "out"]
    done = subprocess.run(command, cwd=tmp_path, env=os.environ | shown, capture_output=True, check=False)
    assert done.returncode == SOLVED, done.stderr
    assert b"odd[b]" in done.stderr

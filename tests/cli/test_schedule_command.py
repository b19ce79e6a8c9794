import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from explicable.cli import run

EXAMPLE = Path(__file__).parents[2] / "examples" / "first-response-team"
MAP = "@..*\n####\n*..@\n"


@pytest.fixture
def team(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "team.map").write_text(MAP)
    assert run(["first-response", "encode", "team.map", "--people", "2", "-o", "."]) == 0
    return ["schedule", "domain.pddl", "problem.pddl"]


def test_a_schedule_is_planned_written_drawn_and_described(team, tmp_path, capsys):
    (tmp_path / "durations.toml").write_text("[schemas]\nmove = 2\ncommand = 0.5\n")
    capsys.readouterr()
    files = ["--durations", "durations.toml", "--svg", "s.svg", "-o", "s.plan"]
    assert run([*team, *files, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["makespan"] == record["lower_bound"] == record["objective"] == 7.0
    assert record["reaches_goal"]
    ends = [step["start"] + step["duration"] for step in record["schedule"]]
    assert max(ends) == 7.0
    for step in record["schedule"]:
        assert step["start"] == max((ends[before] for before in step["after"]), default=0.0)
    written = (tmp_path / "s.plan").read_text().splitlines()
    assert len(written) == len(ends) + 1
    assert "6.000: (visit-room r1 c-0-3) [1.000]" in written
    drawing = ET.fromstring((tmp_path / "s.svg").read_text())
    titles = [title.text for title in drawing.iter("{http://www.w3.org/2000/svg}title")]
    assert "6 to 7: (visit-room r1 c-0-3)" in titles
    assert sum(" to " in title for title in titles) == len(ends)


def test_the_steps_of_a_given_plan_overlap(team, capsys):
    assert run(["plan", "domain.pddl", "problem.pddl", "-o", "one.plan"]) == 0
    capsys.readouterr()
    assert run([*team, "one.plan"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 11
    assert float(lines[-1].split("=")[1]) < 10


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["bad.plan"], 3, "bad.plan"),
        (["--durations", "bad.toml"], 3, "bad.toml"),
        (["--alpha", "-1"], 2, "alpha"),
        (["--time-limit", "0"], 2, "time-limit"),
        (["missing.plan"], 2, "missing.plan"),
        (["--durations", "huge.toml"], 3, "huge.toml: the duration of move"),
        (["--durations", "stranger.toml"], 3, "stranger.toml: there is no action fly"),
    ],
)
def test_wrong_use_and_bad_files_are_named(team, tmp_path, capsys, arguments, code, says):
    (tmp_path / "bad.plan").write_text("(visit-room r1 c-0-3)\n")
    (tmp_path / "bad.toml").write_text("default = 0\n")
    (tmp_path / "huge.toml").write_text(f"[schemas]\nmove = 1{400 * '0'}\n")
    (tmp_path / "stranger.toml").write_text("[schemas]\nfly = 1\n")
    assert run([*team, *arguments]) == code
    assert says in capsys.readouterr().err


def test_what_cannot_be_reached_is_said_to_be_so(team, tmp_path, capsys):
    text = (tmp_path / "problem.pddl").read_text()
    (tmp_path / "problem.pddl").write_text(text.replace("(clear c-0-2)", ""))
    assert run(team) == 4
    assert "no plan" in capsys.readouterr().err
    assert run([*team, "--json"]) == 4
    assert json.loads(capsys.readouterr().out)["schedule"] is None


def test_the_example_of_two_robots_and_two_people(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["first-response", "encode", str(EXAMPLE / "team.map"), "--people", "2", "-o", "."]) == 0
    assert run(["plan", "domain.pddl", "problem.pddl", "-o", "first.plan"]) == 0
    capsys.readouterr()
    arguments = ["--durations", str(EXAMPLE / "durations.toml"), "--time-limit", "3", "--json"]
    assert run(["schedule", "domain.pddl", "problem.pddl", *arguments]) == 0
    record = json.loads(capsys.readouterr().out)
    assert {"r1", "r2", "person"} <= {step["agent"] for step in record["schedule"]}
    assert run(["schedule", "domain.pddl", "problem.pddl", "first.plan", *arguments]) == 0
    first = json.loads(capsys.readouterr().out)  # how much better it gets in the time, the machine decides
    one_by_one = sum(step["duration"] for step in record["schedule"])
    assert record["makespan"] <= first["makespan"] < one_by_one


def test_a_plan_short_of_the_goal_is_scheduled_with_a_warning(team, tmp_path, capsys):
    assert run(["plan", "domain.pddl", "problem.pddl", "-o", "one.plan"]) == 0
    first = (tmp_path / "one.plan").read_text().splitlines()[0]
    (tmp_path / "short.plan").write_text(first + "\n")
    capsys.readouterr()
    assert run([*team, "short.plan"]) == 0
    assert "warning: short.plan: the plan does not reach the goal" in capsys.readouterr().err


def test_what_a_plan_tells_is_scheduled_too(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "detour.map").write_text("@x*\n...\n")
    assert run(["first-response", "encode", "detour.map", "-o", "."]) == 0
    human = ["--human-domain", "human-domain.pddl", "--human-problem", "human-problem.pddl"]
    schedule = ["schedule", "domain.pddl", "problem.pddl", *human]
    told = "(command person c-0-2)\n(tell r1 clear c-0-1 does not hold)\n(move r1 c-0-0 c-1-0)\n"
    (tmp_path / "told.plan").write_text(told)
    (tmp_path / "durations.toml").write_text("[schemas]\ntell = 4\n")
    capsys.readouterr()
    assert run([*schedule, "told.plan", "--durations", "durations.toml", "--svg", "s.svg"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1:] == [
        "1.000: (tell r1 clear c-0-1 does not hold) [4.000]",
        "5.000: (move r1 c-0-0 c-1-0) [1.000]",
        "; makespan = 6",
    ]
    # It stands with the robot that tells, and with the person who listens.
    assert (tmp_path / "s.svg").read_text().count("1 to 5: (tell r1 clear c-0-1 does not hold)") == 2
    (tmp_path / "told.plan").write_text(told.replace("does not hold", "holds"))
    assert run([*schedule, "told.plan"]) == 3
    assert "told.plan:2: 'clear c-0-1 holds' is no difference" in capsys.readouterr().err

"""The command line as a user types it: real processes, real files."""

import json
import re
from xml.etree import ElementTree as ET

import pytest
from typed_commands import BAD_INPUT, HUMAN, LIMIT, SOLVED, TASK, UNSOLVABLE, USAGE, Finished, explicable

from explicable.cli import prices
from explicable.model.grounding import ground_team
from explicable.model.plan import read_plan
from explicable.pddl import read_team_problem
from explicable.planning import team_plan


def plan_as_json(place, *options):
    done = explicable("plan", *TASK, *HUMAN, "--json", *options, cwd=place)
    assert done.code == SOLVED, done.err
    return json.loads(done.out)


@pytest.mark.parametrize(
    "options",
    [
        [],
        ["--search", "ff"],
        ["--labeller", "labeller.json"],
        ["--labeller", "labeller.json", "--planner", "ff"],
        ["--labeller", "labeller.json", "--mode", "paper"],
        ["--labeller", "labeller.json", "--alpha", "0", "--search", "eager"],
    ],
)
def test_plan_solves_the_task_it_was_given(place, options):
    answer = plan_as_json(place, *options, "-o", "plan.txt")
    team = ground_team(read_team_problem(*(place / name for name in TASK)))
    actions = read_plan(place / "plan.txt")
    execution = team.task.execute(actions)
    assert team.task.is_goal(execution.states[-1])
    assert answer["plan"] == [f"({' '.join(action)})" for action in actions]
    assert answer["cost"] == execution.cost == len(actions)
    assert (place / "plan.txt").read_text().endswith(f"; cost = {execution.cost}\n")
    assert set(answer["agents"]) == {"r1", "person"}
    assert {"read_s", "ground_s", "search_s"} == set(answer["time"])
    scored = "--labeller" in options
    assert all(
        (answer["scores"][name] is not None) == scored for name in ("f_paper", "f_robot", "f_expected")
    )


def test_the_label_command_recomputes_the_plan_commands_scores(place):
    answer = plan_as_json(place, "--labeller", "labeller.json", "-o", "scored.txt")
    done = explicable("label", "labeller.json", *TASK, "scored.txt", *HUMAN, "--json", cwd=place)
    assert json.loads(done.out)["scores"].items() >= answer["scores"].items()


def test_plan_goes_to_standard_output(place):
    done = explicable("plan", "lamp-domain.pddl", "lamp.pddl", cwd=place)
    assert done == Finished(SOLVED, "(press)\n; cost = 1\n", "")


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["plan", "lamp-domain.pddl", "broken-lamp.pddl"], UNSOLVABLE, "unsolvable"),
        (["plan", *TASK, "--time-limit", "0"], LIMIT, "limit"),
        (["plan", *TASK, "--time-limit", "nan"], USAGE, "--time-limit"),
        (["plan", *TASK, "--planner", "explicable"], USAGE, "--labeller"),
        (["plan", *TASK, "--mode", "paper"], USAGE, "--mode paper"),
        (["plan", *TASK, "--labeller", "labeller.json", "--alpha", "-1"], USAGE, "alpha"),
        (["plan", *TASK, "--labeller", "labeller.json", "--alpha", "nan"], USAGE, "alpha"),
        (["plan", *TASK, "--labeller", "labeller.json", "--alpha", "inf"], USAGE, "alpha"),
        (["plan", "missing.pddl", "lamp.pddl"], USAGE, "missing.pddl"),
        (["plan", "lamp-domain.pddl", "task/problem.pddl"], BAD_INPUT, "task/problem.pddl:"),
        (["plan", *TASK, "--labeller", "traces.jsonl"], BAD_INPUT, "traces.jsonl"),
        (
            ["plan", "lamp-domain.pddl", "lamp.pddl", "--labeller", "labeller.json"],
            BAD_INPUT,
            "another domain",
        ),
        (["label", "labeller.json", *TASK, "traces.jsonl"], BAD_INPUT, "traces.jsonl:1"),
        (
            ["first-response", "simulate", "maps/map-000.map", "--family", "saints", "-o", "x"],
            USAGE,
            "saints",
        ),
        (["train", "traces.jsonl", "-o", "x", "--augment", "9" * 20], USAGE, "--augment"),
        (["train", "traces.jsonl", "-o", "x", "--bootstrap", "9" * 20], USAGE, "--bootstrap"),
        (["walk"], USAGE, "walk"),
    ],
)
def test_one_message_and_a_documented_exit_code(place, arguments, code, message):
    done = explicable(*arguments, cwd=place)
    assert done.code == code, done
    assert message in done.err
    assert done.out == ""


def test_a_human_model_without_a_way_to_the_goal_is_told_of_and_can_be_ignored(place):
    believed = (place / "task/human-problem.pddl").read_text()
    (place / "no-way.pddl").write_text(re.sub(r"\(clear [^)]*\)", "", believed))
    human = ["--human-domain", "task/human-domain.pddl", "--human-problem", "no-way.pddl"]
    for labeller in ([], ["--labeller", "labeller.json"]):
        warned = explicable("plan", *TASK, *human, *labeller, cwd=place)
        assert warned.code == SOLVED
        assert warned.err.startswith("explicable: warning: in the human model the goal can't be reached")
        assert warned.err.count("in the human model") == 1
        ignored = explicable("plan", *TASK, *human, *labeller, "--ignore-human", cwd=place)
        assert (ignored.code, ignored.err) == (SOLVED, "")
    assert plan_as_json(place)["outcome"] == "solved"  # no word of it where there is a way


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("#@*\n##\n", "bad.map:2"),
        ("#@?*\n", "bad.map:1:3"),
        ("..*\n", "robot"),
        ("@..\n", "mark"),
        ("@#*\n", "reach"),
        ("", "bad.map"),
    ],
)
def test_a_bad_map_is_named_and_nothing_is_written(tmp_path, text, message):
    (tmp_path / "bad.map").write_text(text)
    for command in (["render", "bad.map", "-o", "out.svg"], ["encode", "bad.map", "-o", "out"]):
        done = explicable("first-response", *command, cwd=tmp_path)
        assert done.code == BAD_INPUT
        assert message in done.err
        assert len(done.err.splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["bad.map"]


def test_a_damaged_trace_or_labeller_is_named_with_its_line(place, tmp_path):
    traces = (place / "traces.jsonl").read_text().splitlines(keepends=True)
    (tmp_path / "traces.jsonl").write_text(traces[0] + traces[1][:-50] + "\n")
    labeller = (place / "labeller.json").read_text()
    (tmp_path / "labeller.json").write_text(labeller.replace('"c2": 1.0', '"c2": 0.4'))
    trained = explicable("train", "traces.jsonl", "-o", "new.json", cwd=tmp_path)
    assert trained.code == BAD_INPUT
    assert trained.err.startswith("explicable: traces.jsonl:2:")
    planned = explicable(
        "plan", *(place / name for name in TASK), "--labeller", "labeller.json", cwd=tmp_path
    )
    assert planned.code == BAD_INPUT
    assert "labeller.json" in planned.err
    assert not (tmp_path / "new.json").exists()


def test_messages_name_the_file_that_is_at_fault(place, tmp_path):
    (tmp_path / "empty.jsonl").write_text("")
    trained = explicable("train", "empty.jsonl", "-o", "new.json", cwd=tmp_path)
    assert (trained.code, trained.err[:24]) == (BAD_INPUT, "explicable: empty.jsonl:")
    (tmp_path / "odd.plan").write_text("(fly r1 moon)\n")
    labelled = explicable(
        "label", place / "labeller.json", *(place / name for name in TASK), "odd.plan", cwd=tmp_path
    )
    assert (labelled.code, labelled.err[:21]) == (BAD_INPUT, "explicable: odd.plan:")


def test_traces_are_checked_merged_and_split(place, tmp_path):
    whole = place / "traces.jsonl"
    assert explicable("traces", "check", whole).code == 0
    done = explicable("traces", "split", whole, "--by", "problem", "-o", tmp_path / "parts")
    parts = sorted((tmp_path / "parts").iterdir())
    assert (done.code, len(parts)) == (0, 4)
    explicable("traces", "merge", *parts, "-o", tmp_path / "again.jsonl")
    assert sorted((tmp_path / "again.jsonl").read_text().splitlines()) == sorted(
        whole.read_text().splitlines()
    )
    record = json.loads(whole.read_text().splitlines()[0])
    record["steps"] = record["steps"][1:]
    (tmp_path / "bad.jsonl").write_text(json.dumps(record) + "\n")
    checked = explicable("traces", "check", tmp_path / "bad.jsonl")
    assert checked.code == BAD_INPUT
    assert "bad.jsonl:1: " in checked.err


def test_pictures_are_well_formed(place, tmp_path):
    plan_as_json(place, "-o", "drawn.txt")
    for view in ("human", "robot"):
        target = tmp_path / f"{view}.svg"
        done = explicable(
            "first-response",
            "render",
            "maps/map-004.map",
            "--view",
            view,
            "--plan",
            "drawn.txt",
            "-o",
            target,
            cwd=place,
        )
        assert done.code == 0
        assert ET.parse(target).getroot().tag.endswith("svg")


def test_a_plan_that_can_not_be_drawn_is_named(place, tmp_path):
    (tmp_path / "bad.plan").write_text("(move r1 c-1-1 kitchen)\n")
    map_file = place / "maps" / "map-004.map"
    drawn = explicable(
        "first-response", "render", map_file, "--plan", "bad.plan", "-o", "x.svg", cwd=tmp_path
    )
    assert drawn.code == BAD_INPUT
    assert drawn.err == "explicable: bad.plan: step 1 (move r1 c-1-1 kitchen) names no cell: 'kitchen'\n"


def test_the_same_seed_makes_the_same_traces(place, tmp_path):
    maps = sorted((place / "maps").iterdir())
    for name in ("one", "two"):
        explicable(
            "first-response", "simulate", *maps, "--seed", "7", "--family", "mission", "-o", tmp_path / name
        )
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


def test_every_command_explains_itself():
    for command in (
        [],
        ["team"],
        ["plan"],
        ["demo"],
        ["explain"],
        ["tell"],
        ["measure"],
        ["rank"],
        ["simulate"],
        ["train"],
        ["label"],
        ["traces"],
        ["first-response"],
    ):
        done = explicable(*command, "--help")
        assert done.code == 0
        assert "Usage" in done.out


def test_the_price_that_help_tells_is_the_planners():
    assert prices.DEFAULT_ALPHA == team_plan.DEFAULT_ALPHA
    assert f"Default: {team_plan.DEFAULT_ALPHA:g}." in " ".join(explicable("plan", "--help").out.split())

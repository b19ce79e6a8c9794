"""`explicable simulate`: any team problem, any family, and games that don't end well."""

import json
from pathlib import Path

import pytest

from cli.test_given_plans import explicable
from explicable.execution import builtin_families, simulate_study
from explicable.labelling import check_traces, read_traces
from explicable.pddl import read_team_problem

ROVERS = Path(__file__).parents[2] / "examples" / "rover-survey"
NAMES = ("domain.pddl", "problem.pddl", "human-domain.pddl", "human-problem.pddl")
FILES = [str(ROVERS / name) for name in ("domain.pddl", "problem.pddl")]
HUMAN = [
    "--human-domain",
    str(ROVERS / "human-domain.pddl"),
    "--human-problem",
    str(ROVERS / "human-problem.pddl"),
]


@pytest.mark.parametrize("way", ["commanded", "autonomous"])
def test_games_become_sound_labelled_traces_and_the_seed_decides(tmp_path, way):
    for name, seed in (("one", "3"), ("same", "3"), ("other", "4")):
        done = explicable(
            tmp_path, "simulate", *FILES, *HUMAN, "--num", "3", "--way", way, "--seed", seed, "-o", name
        )
        assert (done.returncode, done.stdout) == (0, ""), done.stderr
    traces = read_traces(tmp_path / "one")
    assert len(traces) == 3
    assert not check_traces(traces)
    assert {trace.origin for trace in traces} == {"simulated"}
    assert {step.label for trace in traces for step in trace.steps} == {True, False, None}
    assert (tmp_path / "one").read_bytes() == (tmp_path / "same").read_bytes()
    assert (tmp_path / "one").read_bytes() != (tmp_path / "other").read_bytes()


def test_families_of_ones_own(tmp_path):
    (tmp_path / "people.toml").write_text("[stern]\nslack = 0\n[fond]\nslack = 1000\n")
    labels = {}
    for family in ("stern", "fond"):
        who = ["--families", "people.toml", "--family", family]
        assert explicable(tmp_path, "simulate", *FILES, *HUMAN, *who, "-o", family).returncode == 0
        record = json.loads((tmp_path / family).read_text())
        labels[family] = [step["label"] for step in record["steps"]]
    assert False in labels["stern"]
    assert False not in labels["fond"]
    done = explicable(tmp_path, "simulate", *FILES, "--families", "people.toml", "-o", "x")
    assert done.returncode == 2
    assert "choose stern, fond" in done.stderr


def test_a_game_that_leads_nowhere_is_said(tmp_path):
    text = Path(FILES[1]).read_text()
    (tmp_path / "cut-off.pddl").write_text(text.replace("(antenna lander) (antenna mesa)", ""))
    done = explicable(tmp_path, "simulate", FILES[0], "cut-off.pddl", "-o", "traces")
    assert done.returncode == 0
    assert "warning: 1 of 1 games: nobody knew how to go on" in done.stderr


def test_a_plan_unlike_all_games_is_warned_of_until_people_have_labelled_it(tmp_path):
    play = ["simulate", *FILES, *HUMAN, "--way", "commanded", "--num", "4", "-o", "games"]
    assert explicable(tmp_path, *play).returncode == 0
    assert explicable(tmp_path, "plan", *FILES, *HUMAN, "--search", "ff", "-o", "ff.plan").returncode == 0
    shown = explicable(
        tmp_path, "simulate", *FILES, *HUMAN, "--plan", "ff.plan", "--num", "3", "-o", "watched"
    )
    assert shown.returncode == 0, shown.stderr
    traces = read_traces(tmp_path / "watched")
    assert not check_traces(traces)
    assert [trace.annotator[-1] for trace in traces] == ["1", "2", "3"]
    assert len({trace.actions for trace in traces}) == 1
    unfamiliar = {}
    for name, learned in (("before", ["games"]), ("after", ["games", "watched"])):
        assert explicable(tmp_path, "train", *learned, "--bootstrap", "0", "-o", name).returncode == 0
        done = explicable(tmp_path, "label", name, *FILES, "ff.plan", *HUMAN, "--json")
        unfamiliar[name] = sum(step["unfamiliar"] for step in json.loads(done.stdout)["steps"])
        assert ("show something that no trace showed" in done.stderr) == (name == "before")
        options = ["--planner", "ff", "--search", "ff", "--labeller", name, "--json"]
        planned = explicable(tmp_path, "plan", *FILES, *HUMAN, *options)
        assert json.loads(planned.stdout)["num_unfamiliar"] == unfamiliar[name]
        assert ("show something that no trace showed" in planned.stderr) == (name == "before")
    assert unfamiliar["before"] > 10
    assert unfamiliar["after"] == 0


def test_what_can_not_be_shown_is_refused(tmp_path):
    (tmp_path / "odd.plan").write_text("(send scout summit mesa)\n")
    done = explicable(tmp_path, "simulate", *FILES, *HUMAN, "--plan", "odd.plan", "-o", "x")
    assert (done.returncode, (tmp_path / "x").exists()) == (3, False)
    assert "odd.plan:1" in done.stderr
    done = explicable(tmp_path, "simulate", *FILES, "--plan", "odd.plan", "--way", "mixed", "-o", "x")
    assert done.returncode == 2


def test_python_plays_as_the_command_line_does(tmp_path):
    assert explicable(tmp_path, "simulate", *FILES, *HUMAN, "--num", "8", "-o", "traces").returncode == 0
    problem = read_team_problem(*(ROVERS / name for name in NAMES))
    episodes = simulate_study([problem], builtin_families()["myopic"], num_traces=8)
    assert [trace.steps for trace in read_traces(tmp_path / "traces")] == [e.trace.steps for e in episodes]

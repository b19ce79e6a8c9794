"""Commands on plans that are handed in: measure, rank, explain."""

import json
import subprocess
import sys

import pytest

from explicable.first_response.encoding import encode
from explicable.first_response.world import parse_map
from explicable.labelling import LabelledStep, Trace, problem_texts, write_traces
from explicable.model.plan import format_plan, parse_plan
from planning.floors import DETOUR, command, judge_of_progress, moves, visit

SHORT = [command(1, 3), *moves((1, 1), (1, 2), (1, 3)), visit(1, 3)]
LONG = [command(1, 3), *moves((1, 1), (2, 1), (2, 2), (2, 3), (1, 3)), visit(1, 3)]
LATE = [*LONG[1:-1], LONG[0], LONG[-1]]
TEAM = ["domain.pddl", "problem.pddl"]
HUMAN = ["--human-domain", "human-domain.pddl", "--human-problem", "human-problem.pddl"]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plans")
    problem = encode(parse_map(DETOUR))
    (folder / "exclusive").mkdir()
    for subfolder, one in ((folder, problem), (folder / "exclusive", encode(parse_map(DETOUR), "exclusive"))):
        for part, text in problem_texts(one).items():
            (subfolder / f"{part.replace('_', '-')}.pddl").write_text(text)
    for name, plan in (("short", SHORT), ("long", LONG), ("late", LATE)):
        (folder / f"{name}.plan").write_text(format_plan(plan, len(plan)))
    steps = tuple(LabelledStep(problem.agent_of(action).name, action) for action in LONG)
    write_traces(folder / "people.jsonl", [Trace(problem, steps, "anna", "person")] * 3)
    judge_of_progress().save(folder / "labeller.json")
    return folder


def explicable(place, *arguments):
    done = subprocess.run(
        [sys.executable, "-m", "explicable", *arguments],
        capture_output=True,
        text=True,
        cwd=place,
        timeout=120,
        check=False,
    )
    assert "Traceback" not in done.stderr
    return done


def test_measure_prints_what_the_function_finds(place):
    options = ["--labeller", "labeller.json", "--expected", "short.plan", "--other-goal", "(at r1 c-2-1)"]
    done = explicable(place, "measure", *TEAM, "long.plan", *HUMAN, *options, "--json")
    assert done.returncode == 0, done.stderr
    record = json.loads(done.stdout)
    assert (record["cost"], record["cost_gap"], record["reaches_goal"]) == (6, 2, True)
    assert record["distance_actions"] == 0.75
    assert record["step_probabilities"][0] is None
    assert 0 < record["legibility"] < 1
    assert 0 < record["f_expected"] < 1
    text = explicable(place, "measure", *TEAM, "long.plan", *HUMAN, *options)
    assert "cost_gap           2\n" in text.stdout


def test_measure_without_labeller_or_in_no_time(place):
    done = explicable(place, "measure", *TEAM, "long.plan", *HUMAN, "--time-limit", "0", "--json")
    record = json.loads(done.stdout)
    assert not record["in_time"]
    assert record["surprise"] is None
    assert "f_paper" not in record


def test_rank_orders_by_j_and_lists_what_is_no_plan_last(place):
    plans = ["short.plan", "late.plan", "long.plan"]
    done = explicable(place, "rank", "labeller.json", *TEAM, *plans, *HUMAN, "--alpha", "2", "--json")
    assert done.returncode == 0, done.stderr
    ranked = json.loads(done.stdout)["plans"]
    assert ranked[-1]["file"] == "short.plan"
    assert "step 2" in ranked[-1]["objection"]
    assert ranked[0]["objective"] <= ranked[1]["objective"]
    lines = explicable(place, "rank", "labeller.json", *TEAM, *plans, *HUMAN).stdout.splitlines()
    assert len(lines) == 3
    assert lines[-1].startswith(" -  short.plan: no plan: step 2")


def test_human_steps_are_scored_where_traces_of_people_are_given(place):
    people = ["--people", "people.jsonl", "--json"]
    done = explicable(place, "rank", "labeller.json", *TEAM, "late.plan", "long.plan", *HUMAN, *people)
    plausible = {plan["file"]: plan["f_human"] for plan in json.loads(done.stdout)["plans"]}
    assert all(0 < p < 1 for p in plausible.values())
    done = explicable(place, "measure", *TEAM, "long.plan", *HUMAN, *people)
    assert json.loads(done.stdout)["f_human"] == plausible["long.plan"]


def test_explain_says_what_the_person_does_not_know(place):
    done = explicable(place, "explain", "labeller.json", *TEAM, "long.plan", *HUMAN)
    lines = done.stdout.splitlines()
    assert len(lines) == len(LONG)
    assert "(clear c-1-2) does not hold" in lines[1]
    done = explicable(place, "explain", "labeller.json", *TEAM, "long.plan", *HUMAN, "--json")
    step = json.loads(done.stdout)["steps"][1]
    assert (step["finding"], step["told"]) == ("explained", ["(clear c-1-2) does not hold"])


def test_tell_puts_what_to_tell_into_the_plan(place):
    cheap = ["--alpha", "20", "--telling-cost", "0.1"]
    options = [*TEAM, *HUMAN, "--seed", "1"]
    done = explicable(place, "tell", "labeller.json", *exclusive(options), *cheap)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert "; tell: (clear c-1-2) does not hold" in lines
    assert parse_plan(done.stdout)[-1] == visit(1, 3)
    done = explicable(place, "tell", "labeller.json", *exclusive(options), *cheap, "--json")
    record = json.loads(done.stdout)
    assert lines[record["before_step"]].startswith("; tell")
    assert record["objective"] < record["objective_untold"]
    assert record["is_complete"]
    dear = explicable(place, "tell", "labeller.json", *exclusive(options), "--telling-cost", "99")
    assert "tell" not in dear.stdout


def exclusive(arguments):
    return [f"exclusive/{name}" if name.endswith(".pddl") else name for name in arguments]


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["rank", "labeller.json", *TEAM, "short.plan", *HUMAN], 3, ""),
        (["rank", "labeller.json", *TEAM, "long.plan", "--alpha", "nan"], 2, "alpha"),
        (["rank", "labeller.json", *TEAM], 2, "PLAN"),
        (["tell", "labeller.json", *TEAM, "--telling-cost", "-1"], 2, "telling"),
        (["measure", *TEAM, "short.plan", *HUMAN], 3, "step 2"),
        (["measure", *TEAM, "problem.pddl", *HUMAN], 3, "problem.pddl:1"),
        (["measure", *TEAM, "long.plan", "--temperature", "0"], 2, "temperature"),
        (["measure", *TEAM, "long.plan", "--other-goal", "nonsense"], 3, "nonsense"),
    ],
)
def test_one_message_and_a_documented_exit_code(place, arguments, code, message):
    done = explicable(place, *arguments)
    assert done.returncode == code, done
    assert message in done.stderr
    assert len(done.stderr.splitlines()) <= 4


def test_front_lists_plans_and_chooses_by_budget(place):
    options = ["--max-cost-increase", "0.5", "-o", "chosen.plan", "--json"]
    done = explicable(place, "front", "labeller.json", *TEAM, *HUMAN, *options)
    assert done.returncode == 0, done.stderr
    record = json.loads(done.stdout)
    chosen = record["plans"][record["chosen"]]
    assert chosen["is_proved"]
    assert chosen["cost"] <= 1.5 * record["plans"][0]["cost"]
    lines = (place / "chosen.plan").read_text().splitlines()
    assert lines == [*chosen["plan"], f"; cost = {chosen['cost']}"]
    text = explicable(place, "front", "labeller.json", *TEAM, *HUMAN)
    assert len(text.stdout.splitlines()) == len(record["plans"])
    assert text.stdout.startswith("cost = ")


def test_front_refuses_what_has_no_meaning(place):
    for options in (["-o", "x.plan"], ["--max-cost-increase", "-1"], ["--max-alpha", "nan"]):
        done = explicable(place, "front", "labeller.json", *TEAM, *HUMAN, *options)
        assert done.returncode == 2, done.stderr
    done = explicable(place, "front", "labeller.json", *TEAM, *HUMAN, "--min-explicability", "1")
    assert done.returncode == 5

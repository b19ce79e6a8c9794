"""Commands on plans that are handed in: measure, rank, explain."""

import contextlib
import io
import json
import re
from typing import NamedTuple
from xml.etree import ElementTree as ET

import pytest

from explicable.cli import run
from explicable.first_response.encoding import encode
from explicable.first_response.map_file import parse_map
from explicable.labelling import LabelledStep, Trace, problem_texts, write_traces
from explicable.model.plan import format_action, format_plan, parse_plan
from planning.floors import DETOUR, command, judge_of_progress, moves, visit

SHORT = [command(1, 3), *moves((1, 1), (1, 2), (1, 3)), visit(1, 3)]
LONG = [command(1, 3), *moves((1, 1), (2, 1), (2, 2), (2, 3), (1, 3)), visit(1, 3)]
LATE = [*LONG[1:-1], LONG[0], LONG[-1]]
TEAM = ["domain.pddl", "problem.pddl"]
SEARCHES = ["--search-time", "600"]  # they end by themselves: what is proved must not hang on the machine
PLANS = ["--improve-time", "600"]
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
    """Run a command in this process: the other files of this folder start real ones."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.chdir(place), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run(list(arguments))
    return Finished(code, out.getvalue(), err.getvalue())


class Finished(NamedTuple):
    returncode: int
    stdout: str
    stderr: str


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
    assert ["cost_gap", "2"] in [line.split() for line in text.stdout.splitlines()]


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
    assert lines[-1].startswith(" -  short.plan:2: no plan: step 2")


def test_human_steps_are_scored_where_traces_of_people_are_given(place):
    people = ["--people", "people.jsonl", "--json"]
    done = explicable(place, "rank", "labeller.json", *TEAM, "late.plan", "long.plan", *HUMAN, *people)
    plausible = {plan["file"]: plan["f_human"] for plan in json.loads(done.stdout)["plans"]}
    assert all(0 < p < 1 for p in plausible.values())
    done = explicable(place, "measure", *TEAM, "long.plan", *HUMAN, *people)
    assert json.loads(done.stdout)["f_human"] == plausible["long.plan"]


def test_traces_in_which_nobody_acts_are_named(place, tmp_path):
    problem = encode(parse_map(DETOUR))
    silent = Trace(problem, (LabelledStep("r1", LONG[1]),), "anna", "person")
    write_traces(tmp_path / "silent.jsonl", [silent])
    (tmp_path / "empty.jsonl").touch()
    wrong = {"silent": "no trace has a human step", "empty": "there is no trace in it"}
    commands = (
        ["measure", *TEAM, "long.plan"],
        ["plan", *TEAM, "--labeller", "labeller.json", "--charge-human-steps", "1"],
    )
    for name, message in wrong.items():
        file = tmp_path / f"{name}.jsonl"
        for arguments in commands:
            done = explicable(place, *arguments, "--people", str(file))
            assert done.returncode == 3
            assert done.stderr.startswith(f"explicable: {file}: {message}")


def test_what_a_plan_tells_is_left_out_with_a_warning(place):
    told = ["(tell r1 clear c-1-2 does not hold)", *(format_action(action) for action in LONG)]
    (place / "told.plan").write_text("\n".join(told))
    (place / "wrong.plan").write_text("\n".join([*told[:2], format_action(visit(1, 3))]))
    for about in (["measure"], *([name, "labeller.json"] for name in ("label", "rank", "explain"))):
        plain, done = (
            explicable(place, *about, *TEAM, plan, *HUMAN, "--json") for plan in ("long.plan", "told.plan")
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout == plain.stdout.replace("long.plan", "told.plan")
        assert done.stderr.startswith("explicable: warning: told.plan: tellings left out: 1;")
    done = explicable(place, "label", "labeller.json", *TEAM, "wrong.plan", *HUMAN)
    assert done.returncode == 3
    assert "wrong.plan:3: step 2" in done.stderr
    done = explicable(place, "rank", "labeller.json", *TEAM, "wrong.plan", *HUMAN)
    assert "wrong.plan:3: no plan: step 2" in done.stdout


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
    options = [*TEAM, *HUMAN, "--seed", "1", "--time-limit", "600"]
    done = explicable(place, "tell", "labeller.json", *exclusive(options), *cheap)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert "(tell r1 clear c-1-2 does not hold)" in lines
    assert parse_plan(done.stdout)[-1] == visit(1, 3)
    done = explicable(place, "tell", "labeller.json", *exclusive(options), *cheap, "--json")
    record = json.loads(done.stdout)
    (told,) = record["told"]
    assert lines[told["before_step"]].startswith("(tell r1 ")
    same = explicable(place, "plan", *exclusive(options), "--labeller", "labeller.json", *cheap)
    assert same.stdout.splitlines() == lines
    assert record["objective"] < record["objective_untold"]
    assert record["is_complete"]
    dear = explicable(place, "tell", "labeller.json", *exclusive(options), "--telling-cost", "99")
    assert "tell" not in dear.stdout


def test_human_steps_are_charged_by_what_people_do(place):
    plan = ["plan", *TEAM, *HUMAN, "--labeller", "labeller.json", "--json", *PLANS]
    charged = ["--charge-human-steps", "1", "--people", "people.jsonl"]
    record = json.loads(explicable(place, *plan, *charged).stdout)
    assert 0 < record["f_human"] <= 1
    free = record["objective"] - record["human_surprise"]
    assert free >= json.loads(explicable(place, *plan).stdout)["objective"] - 1e-9
    assert record["lower_bound"] == pytest.approx(record["objective"])
    for wrong in (
        ["--charge-human-steps", "1"],
        [*charged, "--mode", "paper"],
        [*charged, "--planner", "ff"],
    ):
        done = explicable(place, *plan, *wrong)
        assert (done.returncode, "labeller" in done.stderr or "--people" in done.stderr) == (2, True)


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
        (["measure", *TEAM, "long.plan", "--other-goal", "(at r1 c-9-9)"], 2, "(at r1 c-9-9) is no atom"),
        (["measure", *TEAM, "long.plan", "--other-goal", "(at r1)"], 2, "(at r1) is no atom"),
    ],
)
def test_one_message_and_a_documented_exit_code(place, arguments, code, message):
    done = explicable(place, *arguments)
    assert done.returncode == code, done
    assert message in done.stderr
    assert len(done.stderr.splitlines()) <= 4


def test_front_lists_plans_and_chooses_by_budget(place, tmp_path):
    options = ["--max-cost-increase", "50%", *SEARCHES, "-o", str(tmp_path / "front"), "--json"]
    done = explicable(place, "front", "labeller.json", *TEAM, *HUMAN, *options)
    assert done.returncode == 0, done.stderr
    record = json.loads(done.stdout)
    chosen = record["plans"][record["chosen"]]
    assert chosen["is_proved"]
    assert chosen["cost"] <= 1.5 * record["plans"][0]["cost"]
    rows = [line.split(",") for line in (tmp_path / "front" / "front.csv").read_text().splitlines()]
    assert rows[0][-2:] == ["chosen", "file"]
    (row,) = (row for row in rows if row[-2] == "yes")
    lines = (tmp_path / "front" / row[-1]).read_text().splitlines()
    assert lines == [*chosen["plan"], f"; cost = {chosen['cost']}"]
    text = explicable(place, "front", "labeller.json", *TEAM, *HUMAN, *SEARCHES)
    assert len(text.stdout.splitlines()) == 1 + len(record["plans"]) == len(rows)
    budget = ["--max-cost-increase", "50%", *PLANS]
    planned = explicable(place, "plan", *TEAM, *HUMAN, "--labeller", "labeller.json", *budget, "--json")
    assert json.loads(planned.stdout)["plan"] == chosen["plan"]


def test_a_front_is_drawn_with_all_its_plans_and_prices(place, tmp_path):
    for file in ("front.svg", "front.png"):
        options = ["--max-cost-increase", "50%", *SEARCHES, "--plot", str(tmp_path / file), "--json"]
        done = explicable(place, "front", "labeller.json", *TEAM, *HUMAN, *options)
        assert done.returncode == 0, done.stderr
    plans = json.loads(done.stdout)["plans"]
    text = "".join(ET.parse(tmp_path / "front.svg").getroot().itertext())
    for number, plan in enumerate(plans, start=1):
        assert f"plan {number}: E[F] = {plan['scores']['f_expected']:.2f}" in text
        assert plan["alpha_to"] is None or f"{plan['alpha_to']:.2g}" in text
    assert (tmp_path / "front.png").read_bytes().startswith(b"\x89PNG")


def test_budgets_and_prices_without_meaning_are_refused(place):
    front = ["front", "labeller.json", *TEAM, *HUMAN]
    plan = ["plan", *TEAM, *HUMAN, "--labeller", "labeller.json"]
    priced = (plan, ["tell", "labeller.json", *TEAM], ["rank", "labeller.json", *TEAM, "long.plan"])
    for asked, options in (
        (front, ["--max-cost-increase", "-1"]),
        (front, ["--max-cost-increase", "ten"]),
        (front, ["--max-alpha", "nan"]),
        (front, ["--plot", "x.pdf"]),
        (plan, ["--max-cost-increase", "inf"]),
        (plan, ["--min-explicability", "110%"]),
        (plan, ["--min-explicability", "0.5", "--alpha", "2"]),
        (plan, ["--min-explicability", "0.5", "--planner", "ff"]),
        (["plan", *TEAM], ["--min-explicability", "0.5"]),
        *((asked, ["--alpha", price]) for price in ("-1", "inf", "nan") for asked in priced),
    ):
        done = explicable(place, *asked, *options)
        assert done.returncode == 2, (asked, options, done.stderr)
        assert done.stdout == ""
    for asked in (front, plan):
        done = explicable(place, *asked, "--min-explicability", "1")
        assert done.returncode == 5
        assert "budget" in done.stderr
    assert explicable(place, *front, "--time-limit", "0").returncode == 5
    (place / "walled.pddl").write_text(re.sub(r"\(clear [^)]*\)", "", (place / "problem.pddl").read_text()))
    assert explicable(place, "front", "labeller.json", "domain.pddl", "walled.pddl").returncode == 4


def on_the_floor(name, labeller, *human):
    """The command line of a command that takes a labeller, and a plan if it needs one."""
    plans = [] if name in {"front", "tell", "plan"} else ["long.plan"]
    if name in {"measure", "plan", "schedule"}:
        return [name, *TEAM, *plans, "--labeller", labeller, *human]
    return [name, labeller, *TEAM, *plans, *human]


@pytest.mark.parametrize("name", ["label", "measure", "rank", "explain", "front", "tell", "plan", "schedule"])
def test_a_labeller_of_another_domain_is_refused_and_a_partly_known_one_warned_of(place, tmp_path, name):
    for schemas, code in ((["fly", "land"], 3), (["move", "fly"], 0)):
        labeller = judge_of_progress()
        labeller.schemas = tuple(schemas)
        file = tmp_path / f"{schemas[0]}.json"
        labeller.save(file)
        done = explicable(place, *on_the_floor(name, str(file), *HUMAN))
        assert done.returncode == code, done.stderr
        if code:
            assert done.stderr.startswith(f"explicable: {file}: this labeller was trained on another domain")
        else:
            warned = "the labeller has never seen remove-obstacle, visit-room: what it says"
            assert f"explicable: warning: {file}: {warned}" in done.stderr


NEED_NO_LABELLER = {"team": [], "simulate": ["-o", "played.jsonl"]}


@pytest.mark.parametrize(
    "name",
    ["label", "measure", "rank", "explain", "front", "tell", "plan", "schedule", *NEED_NO_LABELLER],
)
def test_a_human_model_without_a_way_to_the_goal_is_said_everywhere(place, tmp_path, name):
    believed = (place / "human-problem.pddl").read_text()
    (tmp_path / "h.pddl").write_text(re.sub(r"\(clear [^)]*\)", "", believed))
    human = ["--human-domain", "human-domain.pddl", "--human-problem", str(tmp_path / "h.pddl")]
    if name in NEED_NO_LABELLER:
        arguments = [name, *TEAM, *human, *NEED_NO_LABELLER[name]]
    else:
        arguments = on_the_floor(name, "labeller.json", *human)
    warned = explicable(place, *arguments)
    assert warned.returncode == 0, warned.stderr
    assert warned.stderr.startswith("explicable: warning: in the human model the goal can't be reached")
    ignored = explicable(place, *arguments, "--ignore-human")
    assert (ignored.returncode, "human model" in ignored.stderr) == (0, False)


@pytest.mark.parametrize("name", ["label", "measure", "rank", "explain"])
def test_messages_about_a_step_name_the_file_and_the_line(place, tmp_path, name):
    plan = tmp_path / "odd.plan"
    plan.write_text("; a comment\n\n" + format_plan([*LONG[:2], LONG[-1]], 3))
    arguments = on_the_floor(name, "labeller.json", *HUMAN)
    arguments[arguments.index("long.plan")] = str(plan)
    done = explicable(place, *arguments)
    assert done.returncode == 3
    assert f"{plan}:5: " in done.stdout + done.stderr
    assert "step 3, (visit-room r1 c-1-3), lacks (at r1 c-1-3)" in done.stdout + done.stderr


def test_an_expected_plan_that_fails_is_named(place, tmp_path):
    plan = tmp_path / "hoped.plan"
    plan.write_text(format_plan([LONG[-1]], 1))
    done = explicable(place, "measure", *TEAM, "long.plan", *HUMAN, "--expected", str(plan))
    assert (done.returncode, done.stderr[: len(f"explicable: {plan}:1:")]) == (3, f"explicable: {plan}:1:")

"""From traces to a labeller and its labels, as a user types it."""

import json
from xml.etree import ElementTree as ET

import pytest
from typed_commands import BAD_INPUT, HUMAN, SOLVED, TASK, USAGE, explicable

from explicable.labelling.doubt import DEFAULT_DOUBT


def test_the_papers_option_from_training_to_the_plan(place, tmp_path):
    labeller = tmp_path / "ground.json"
    done = explicable("train", "traces.jsonl", "-o", labeller, "--augment", "3", "--json", cwd=place)
    assert done.code == SOLVED, done.err
    summary = json.loads(done.out)
    assert summary["num_copies"] == 3
    assert summary["num_bootstrap"] == 0
    planned = explicable(
        "plan", *TASK, *HUMAN, "--labeller", labeller, "-o", tmp_path / "plan.txt", "--json", cwd=place
    )
    assert planned.code == SOLVED, planned.err
    labelled = explicable(
        "label", labeller, *TASK, tmp_path / "plan.txt", *HUMAN, "--json", "--explain", cwd=place
    )
    answer = json.loads(labelled.out)
    assert answer["scores"].items() >= json.loads(planned.out)["scores"].items()
    spoken = [reason["feature"] for step in answer["steps"] for reason in step["reasons"]]
    assert any("=c-" in text for text in spoken)
    text = (place / "task/problem.pddl").read_text().replace("c-", "cell-").replace("r1", "rover")
    (tmp_path / "renamed.pddl").write_text(text)
    for arguments in (
        ["label", labeller, TASK[0], tmp_path / "renamed.pddl", tmp_path / "plan.txt"],
        ["plan", TASK[0], tmp_path / "renamed.pddl", "--labeller", labeller],
    ):
        refused = explicable(*arguments, cwd=place)
        assert refused.code == BAD_INPUT
        assert "ground.json: this labeller was trained on names" in refused.err


def test_what_no_trace_showed_is_doubted_as_told(place, tmp_path):
    said = {}
    lines = (place / "traces.jsonl").read_text().splitlines(keepends=True)
    (tmp_path / "two.jsonl").write_text("".join(lines[:2]))
    assert explicable("plan", *TASK, "-o", tmp_path / "plan", cwd=place).code == SOLVED
    for doubt in ([], ["--doubt", "0"], ["--doubt", "2"]):
        options = ["--bootstrap", "0", *doubt, "-o", tmp_path / "l.json", "--json"]
        done = explicable("train", tmp_path / "two.jsonl", *options, cwd=place)
        assert done.code == SOLVED, done.err
        price = json.loads(done.out)["doubt"]
        done = explicable(
            "label", tmp_path / "l.json", *TASK, tmp_path / "plan", "--json", "--explain", cwd=place
        )
        answer = json.loads(done.out)
        said[price] = answer["scores"]["f_expected"]
        shown = [step for step in answer["steps"] if step["unfamiliar"]]
        assert shown
        if price > 1:
            assert any("no trace showed the like" in str(step["reasons"]) for step in shown)
    assert set(said) == {DEFAULT_DOUBT, 0.0, 2.0}
    assert said[0.0] > said[DEFAULT_DOUBT] > said[2.0]
    refused = explicable(
        "train", "traces.jsonl", "--augment", "3", "--doubt", "1", "-o", tmp_path / "no", cwd=place
    )
    assert (refused.code, (tmp_path / "no").exists()) == (USAGE, False)
    help_text = " ".join(explicable("train", "--help").out.split())
    assert f"not with --augment. Default: {DEFAULT_DOUBT}." in help_text


def test_held_out_figures_and_their_picture(place, tmp_path):
    options = ["--bootstrap", "3", "--cross-validate", "2", "--calibration", tmp_path / "calibration.svg"]
    done = explicable("train", "traces.jsonl", "-o", tmp_path / "l.json", *options, cwd=place)
    assert done.code == SOLVED, done.err
    assert "log-loss" in done.out
    assert ET.parse(tmp_path / "calibration.svg").getroot().tag.endswith("svg")
    again = explicable("train", "traces.jsonl", "-o", tmp_path / "l.json", *options, "--json", cwd=place)
    held_out = json.loads(again.out)["held_out"]
    assert held_out["num_traces"] == 8
    assert sum(held_out["calibration"]["num_steps"]) == held_out["num_steps"]
    assert 0 <= held_out["mae_all_steps"] <= held_out["mae_robot"] <= 1
    for wrong, message in (
        (["--cross-validate", "9"], "9 folds by problem need as many"),
        (["--calibration", "c.svg"], "--calibration needs --cross-validate"),
    ):
        refused = explicable("train", "traces.jsonl", "-o", tmp_path / "no.json", *wrong, cwd=place)
        assert (refused.code, (tmp_path / "no.json").exists()) == (USAGE, False)
        assert message in refused.err


def test_labels_that_are_all_alike_teach_with_a_warning(place, tmp_path):
    traces = [json.loads(line) for line in (place / "traces.jsonl").read_text().splitlines()]
    for trace in traces:
        for step in trace["steps"]:
            step["label"] = None if step["label"] is None else True
    (place / "alike.jsonl").write_text("".join(json.dumps(trace) + "\n" for trace in traces))
    options = ["--bootstrap", "0", "-o", tmp_path / "l.json"]
    done = explicable("train", "alike.jsonl", *options, cwd=place)
    assert done.code == SOLVED, done.err
    assert "all labels say explicable" in done.err
    assert "all labels" not in explicable("train", "traces.jsonl", *options, cwd=place).err


@pytest.mark.parametrize(
    "arguments",
    [
        ["traces", "check"],
        ["train", "-o", "l.json"],
        ["demo", "--traces"],
        ["measure", *TASK, "plan", "--people"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_trace_that_cannot_be_executed_is_named_by_file_line_and_step(place, arguments):
    good, bad = map(json.loads, (place / "traces.jsonl").read_text().splitlines()[:2])
    bad["steps"][1]["operator"] = "(move r1 c-1-1 nowhere)"
    (place / "blank.jsonl").write_text(f"{json.dumps(good)}\n\n{json.dumps(bad)}\n")
    (place / "plan").touch()
    done = explicable(*arguments, "blank.jsonl", cwd=place)
    assert done.code == BAD_INPUT
    assert done.err.startswith("explicable: blank.jsonl:3: step 2, (move r1 c-1-1 nowhere), names an unknown")


@pytest.fixture
def steps(place):
    """The first trace of the study as plain text, with a problem of its own."""
    record = json.loads((place / "traces.jsonl").read_text().splitlines()[0])
    words = {True: "yes", False: "no", None: "?"}
    lines = [f"{step['operator'].strip('()')} {words[step['label']]}" for step in record["steps"]]
    return record, lines


def files_of(record, folder):
    for name, text in record["problem"].items():
        (folder / f"{name}.pddl").write_text(text)
    human = ["--human-domain", folder / "human_domain.pddl", "--human-problem", folder / "human_problem.pddl"]
    return [folder / "domain.pddl", folder / "problem.pddl", *human, "--annotator", "anna"]


def test_plain_text_becomes_traces(steps, tmp_path):
    record, lines = steps
    (tmp_path / "steps.txt").write_text("\n".join([*lines, "", "", *lines[:3]]) + "\n")
    where = [*files_of(record, tmp_path), "-o", tmp_path / "traces.jsonl"]
    done = explicable(
        "traces", "import", tmp_path / "steps.txt", *where, "--explicable", "yes", "--inexplicable", "no"
    )
    assert done.code == SOLVED, done.err
    first, second = map(json.loads, (tmp_path / "traces.jsonl").read_text().splitlines())
    assert first["steps"] == record["steps"]
    assert second["steps"] == record["steps"][:3]
    assert (first["annotator"], first["origin"]) == ("anna", "person")
    assert explicable("traces", "check", tmp_path / "traces.jsonl").code == SOLVED


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "there is no step in it"),
        ("yes\n", "steps.txt:1: expected one step"),
        ("move r1 c-1-1 c-9-9 yes\n", "trace 1: step 1"),
        ("? yes\n\nhello, world\n", "steps.txt:1: '?' is no action of the domain; those are command, move"),
        (
            "command person c-1-1 ?\nmove r1 c-1-1\n",
            "steps.txt:2: move takes 3 objects, found 1 (the last word",
        ),
        ("command person c-1-1 maybe\nmove r1 c-1-1 Yes\n", "steps.txt:2: 'Yes' can't be a task's name"),
    ],
)
def test_plain_text_that_is_no_trace_is_refused(steps, tmp_path, text, message):
    (tmp_path / "steps.txt").write_text(text)
    where = [*files_of(steps[0], tmp_path), "-o", tmp_path / "traces.jsonl"]
    done = explicable(
        "traces", "import", tmp_path / "steps.txt", *where, "--explicable", "yes", "--inexplicable", "no"
    )
    assert (done.code, (tmp_path / "traces.jsonl").exists()) == (BAD_INPUT, False)
    assert message in done.err


@pytest.mark.parametrize(
    "arguments",
    [["check"], ["merge", "-o", "new.jsonl"], ["split", "--by", "annotator", "-o", "parts"]],
)
def test_a_file_without_traces_is_an_error(place, tmp_path, arguments):
    (tmp_path / "empty.jsonl").write_text("\n")
    done = explicable("traces", *arguments, place / "traces.jsonl", "empty.jsonl", cwd=tmp_path)
    assert done.code == BAD_INPUT
    assert "explicable: empty.jsonl: there is no trace in it" in done.err
    assert [path.name for path in tmp_path.iterdir()] == ["empty.jsonl"]


def test_a_file_named_twice_counts_once_and_is_warned_of(place, tmp_path):
    whole = place / "traces.jsonl"
    done = explicable("traces", "merge", whole, place / "." / "traces.jsonl", "-o", tmp_path / "new.jsonl")
    assert done.code == SOLVED
    assert "warning: " in done.err
    assert "named more than once" in done.err
    assert (tmp_path / "new.jsonl").read_text() == whole.read_text()

"""From simulated participants to plans that simulated participants label: every step as a user types it."""

import csv
import hashlib
import json
import re

import pyarrow.parquet as pq
import pytest

from explicable.cli import run
from explicable.labelling import check_traces, read_traces, write_traces

STUDY = """
title = "A study"
practice = "maps/map-000.map"
tasks_each = 2
[[rating]]
name = "robot"
text = "How was the robot?"
"""
PLAYED = '[[task]]\nname = "{name}"\nmap = "maps/{name}.map"\npeople = 2\n'
REPLAYED = (
    '[[task]]\nname = "{name}-{source}"\nmap = "maps/{name}.map"\nplan = "{source}.txt"\n'
    'source = "{source}"\npeople = 3\n'
)


def read_lines(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def explicable(*arguments):
    assert run([str(argument) for argument in arguments]) == 0


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """A study that simulated participants have played, and its data."""
    folder = tmp_path_factory.mktemp("line")
    study = folder / "played"
    explicable(
        "first-response",
        "generate",
        "--num",
        4,
        "--height",
        4,
        "--width",
        4,
        "--marks",
        2,
        "-o",
        study / "maps",
    )
    names = ["map-001", "map-002", "map-003"]
    (study / "study.toml").write_text(STUDY + "".join(PLAYED.format(name=name) for name in names))
    explicable("study", "simulate", study, "-n", 3, "--family", "myopic", "--seed", 1)
    explicable("study", "export", study, "-o", folder / "data")
    return folder


def test_the_data_are_complete_marked_and_checked(played):
    data = played / "data"
    told = json.loads((data / "checksums.json").read_text())
    for name, checksum in told["sha256"].items():
        assert hashlib.sha256((data / name).read_bytes()).hexdigest() == checksum
    for table in ("labelled-steps", "participants", "sessions", "assignments", "answers", "events"):
        name = {"labelled-steps": "labelledSteps"}.get(table, table)
        with (data / "data" / f"study-data_description-{name}_data.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        lines = read_lines(data / "jsonl" / f"{table}.jsonl")
        parquet = pq.read_table(data / "parquet" / f"{table}.parquet").to_pylist()
        assert parquet == lines
        assert len(rows) == len(lines) == told["rows"][table] > 0
        assert {row["origin"] for row in rows} == {"simulated"}
        codebook = (data / "CODEBOOK.md").read_text()
        assert all(f"`{column}`" in codebook for column in rows[0])
    assert told["rows"]["traces"] == 6
    assert not (data / "traces" / "traces.jsonl").exists()  # no people took part


def test_the_data_keep_the_rules_of_psych_ds(played):
    """Those of its schema, version 1.5.1, whose breach is an error, and of schema.org's properties."""
    data = played / "data"
    described = json.loads((data / "dataset_description.json").read_text(encoding="utf-8"))
    assert described["@context"].rstrip("/") == "https://schema.org"
    assert described["@type"] == "Dataset"
    of_datasets = {"name", "description", "variableMeasured", "dateCreated", "version", "identifier"}
    assert described.keys() - {"@context", "@type"} == of_datasets
    columns = set()
    for path in (data / "data").iterdir():
        assert re.fullmatch(r"([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv", path.name)
        with path.open(newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
        assert all(len(row) == len(header) == len(set(header)) for row in rows)
        columns |= set(header)
    measured = described["variableMeasured"]
    assert {variable["name"] for variable in measured} == columns
    assert len(measured) == len(columns)
    assert all(variable["@type"] == "PropertyValue" and variable["description"] for variable in measured)
    assert (data / "README.md").exists()
    assert {"README.md", ".psychds-ignore"} < json.loads((data / "checksums.json").read_text())[
        "sha256"
    ].keys()


def test_the_traces_are_those_of_the_tables(played):
    path = played / "data" / "traces" / "traces-simulated.jsonl"
    traces = read_traces(path)
    assert check_traces(traces, path) == []
    write_traces(played / "again.jsonl", traces)
    assert path.read_bytes() == (played / "again.jsonl").read_bytes()
    steps = read_lines(played / "data" / "jsonl" / "labelled-steps.jsonl")
    labels = [step["explicable"] for step in steps if step["kind"] == "play"]
    assert [step.label for trace in traces for step in trace.steps] == labels
    for trace in traces:
        assert trace.origin == "simulated"
        assert len(trace.notes["study"]) == 64


def test_plans_from_learnt_labels_are_labelled_in_turn(played, capsys):
    data, study = played / "data", played / "replayed"
    labeller, task = played / "labeller.json", played / "task"
    explicable("train", data / "traces" / "traces-simulated.jsonl", "-o", labeller, "--bootstrap", 0)
    explicable(
        "first-response", "encode", played / "played/maps/map-003.map", "-o", task, "--semantics", "exclusive"
    )
    files = [task / "domain.pddl", task / "problem.pddl", "--human-domain", task / "human-domain.pddl"]
    files += ["--human-problem", task / "human-problem.pddl"]
    (study / "maps").mkdir(parents=True)
    for name in ("map-000", "map-003"):
        text = (played / "played/maps" / f"{name}.map").read_text()
        (study / "maps" / f"{name}.map").write_text(text)
    explicable("plan", *files, "-o", study / "ff.txt")
    explicable("plan", *files, "--labeller", labeller, "--time-limit", 5, "-o", study / "explicable.txt")
    replayed = [REPLAYED.format(name="map-003", source=source) for source in ("ff", "explicable")]
    (study / "study.toml").write_text(STUDY + "".join(replayed))
    explicable("study", "simulate", study, "-n", 4, "--family", "mission")
    capsys.readouterr()
    explicable("study", "status", study, "--json")
    summary = json.loads(capsys.readouterr().out)["simulated"]
    assert summary["stages"] == {"debrief": 3}  # the fourth found every plan shown to three people
    assert [(task["finished"], task["wanted"]) for task in summary["tasks"]] == [(3, 3), (3, 3)]
    assert -1 <= summary["agreement"] <= 1
    for plan in summary["plans"]:
        steps = (study / f"{plan['source']}.txt").read_text().splitlines()
        assert plan["cost"] == sum(not step.startswith(";") for step in steps)
    for score in summary["scores"]:
        assert score["source"] in {"ff", "explicable"}
        plan = (study / f"{score['source']}.txt").read_text().splitlines()
        num_robot_steps = sum(not line.startswith(("(command", ";")) for line in plan)
        assert score["num_labels"] == 3 * num_robot_steps
        assert score["low"] <= score["f_robot"] <= score["high"]


def test_who_is_forgotten_leaves_a_tombstone(played, capsys):
    data = read_lines(played / "data/jsonl/participants.jsonl")
    name = data[0]["id"]
    explicable("study", "forget", played / "played", name, "--yes")
    explicable("study", "export", played / "played", "-o", played / "after")
    before, after = (
        json.loads((played / folder / "checksums.json").read_text())["rows"] for folder in ("data", "after")
    )
    assert before["participants"] == after["participants"]
    assert after["sessions"] == before["sessions"] - 1
    for path in (played / "after").rglob("*.jsonl"):
        if path.name != "participants.jsonl":
            assert name not in path.read_text()
    assert run(["study", "forget", str(played / "played"), name, "--yes"]) == 3
    assert "no longer" in capsys.readouterr().err


def test_an_export_overwrites_nothing(played, capsys):
    assert run(["study", "export", str(played / "played"), "-o", str(played / "data")]) == 2
    assert "never overwrites" in capsys.readouterr().err

"""Trace files: exact round trips, shared problems, and a placed error for every kind of damage."""

import hashlib
import json

import pytest

from explicable.errors import TraceError, UsageError
from explicable.first_response.encoding import encode
from explicable.first_response.map_file import parse_map
from explicable.labelling.traces import (
    LabelledStep,
    Trace,
    check_traces,
    problem_checksum,
    problem_texts,
    read_traces,
    split_traces,
    write_traces,
)

STEPS = (
    LabelledStep("person", ("command", "person", "c-1-3"), None, 0.5),
    LabelledStep("r1", ("move", "r1", "c-1-1", "c-1-2"), True),
    LabelledStep("r1", ("move", "r1", "c-1-2", "c-1-3"), False),
    LabelledStep("r1", ("visit-room", "r1", "c-1-3"), None),
)


def make_trace(annotator="anna", rows=("#####", "#@.*#", "#####"), **fields):
    problem = encode(parse_map("\n".join(rows) + "\n"))
    return Trace(problem, STEPS, annotator, "simulated", **fields)


def write_lines(path, *records):
    path.write_text("".join(json.dumps(record) + "\n" for record in records))


@pytest.fixture
def record(tmp_path):
    write_traces(tmp_path / "one.jsonl", [make_trace()])
    return json.loads((tmp_path / "one.jsonl").read_text())


def test_round_trip_is_exact_and_shares_problems(tmp_path):
    traces = [
        make_trace("anna", name="map 1", started="2026-11-22T10:00:00Z", notes={"rating": 7}),
        make_trace("ben", semantics="persistent"),
        make_trace("ben", rows=("####", "#@*#", "####")),
    ]
    path = tmp_path / "traces.jsonl"
    write_traces(path, traces)
    read = read_traces(path)
    assert [t.steps for t in read] == [t.steps for t in traces]
    assert [(t.annotator, t.name, t.started, t.semantics, t.notes) for t in read] == [
        (t.annotator, t.name, t.started, t.semantics, t.notes) for t in traces
    ]
    assert read[0].problem is read[1].problem
    assert read[0].problem is not read[2].problem
    write_traces(tmp_path / "again.jsonl", read)
    assert (tmp_path / "again.jsonl").read_bytes() == path.read_bytes()


def test_split_by_problem_and_annotator():
    traces = [make_trace("anna"), make_trace("ben"), make_trace("ben", rows=("####", "#@*#", "####"))]
    assert [len(group) for group in split_traces(traces, by="problem").values()] == [2, 1]
    assert {key: len(group) for key, group in split_traces(traces, by="annotator").items()} == {
        "anna": 1,
        "ben": 2,
    }
    assert problem_checksum(traces[0].problem) == problem_checksum(traces[1].problem)
    with pytest.raises(UsageError):
        split_traces(traces, by="weather")


def test_problem_by_file_and_checksum(tmp_path, record):
    text = record["problem"]["domain"]
    (tmp_path / "domain.pddl").write_text(text)
    good = {"file": "domain.pddl", "sha256": hashlib.sha256(text.encode()).hexdigest()}
    path = tmp_path / "traces.jsonl"
    write_lines(path, record | {"problem": record["problem"] | {"domain": good}})
    assert problem_texts(read_traces(path)[0].problem)["domain"] == text
    for bad, message in (
        (good | {"sha256": "0" * 64}, "has changed"),
        (good | {"file": "../domain.pddl"}, "beside the trace file"),
        (good | {"file": "/etc/passwd"}, "beside the trace file"),
        (good | {"file": "missing.pddl"}, "can't be read"),
    ):
        write_lines(path, record | {"problem": record["problem"] | {"domain": bad}})
        with pytest.raises(TraceError, match=message):
            read_traces(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"format": "something"}, "not a trace"),
        ({"version": 2}, "version 2"),
        ({"origin": "robot"}, "origin"),
        ({"origin": []}, "origin"),
        ({"steps": {}}, "steps must be a list"),
        ({"steps": [3]}, "step 1 must be an object"),
        ({"steps": [{"agent": "r1", "operator": "(move", "label": None}]}, "step 1: expected one step"),
        ({"steps": [{"agent": "r1", "operator": "(move a)", "label": "yes"}]}, "true, false or null"),
        ({"steps": [{"agent": "r1", "operator": "(move a)"}]}, "no 'label'"),
        ({"steps": [{"agent": "r1", "operator": "(a)", "label": None, "time": 1e300}]}, "time"),
        (
            {"steps": [{"agent": "person", "operator": "(move r1 c-1-1 c-1-2)", "label": None}]},
            r"step 1: \(move r1 c-1-1 c-1-2\) belongs to r1, not to person",
        ),
        ({"started": "yesterday"}, "started must be a date and time in ISO 8601, not 'yesterday'"),
        ({"annotator": ""}, "annotator must be text"),
        ({"annotator": "\ud800"}, "not JSON"),
        ({"colour": "red"}, "unknown key 'colour'"),
        ({"notes": []}, "notes"),
        ({"problem": []}, "problem must be an object"),
        ({"problem": {"domain": "x"}}, "no 'problem'"),
        ({"problem": {"domain": "(define (domain d", "problem": ""}}, "domain, line 1"),
    ],
)
def test_damage_is_placed(tmp_path, record, change, message):
    path = tmp_path / "traces.jsonl"
    write_lines(path, record, record | change)
    with pytest.raises(TraceError, match=message) as caught:
        read_traces(path)
    assert (caught.value.path, caught.value.line) == (path, 2)


@pytest.mark.parametrize(
    "line",
    [b"{", b"\xff\xfe", b'{"a": NaN}', b"[" * 100_000, b'{"a": 1, "a": 2}', b"9" * 5000, b"null"],
)
def test_what_is_no_json_is_refused(tmp_path, line):
    path = tmp_path / "traces.jsonl"
    path.write_bytes(b"\n" + line + b"\n")
    with pytest.raises(TraceError) as caught:
        read_traces(path)
    assert caught.value.line == 2


def test_check_names_trace_and_step():
    good = make_trace()
    wrong_agent = make_trace()
    wrong_agent = Trace(good.problem, (LabelledStep("r2", STEPS[1].action),), "anna", "person")
    blocked = Trace(good.problem, (STEPS[2],), "anna", "person")
    faults = check_traces([good, wrong_agent, blocked], "x.jsonl")
    assert [fault.line for fault in faults] == [2, 3]
    assert "belongs to r1" in faults[0].message
    assert "(move r1 c-1-2 c-1-3)" in faults[1].message

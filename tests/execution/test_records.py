import json

import numpy as np
import pytest
from hospital import hospital
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from explicable.errors import EpisodeError
from explicable.execution import (
    Participant,
    Proposal,
    SimulatedPerson,
    observable_facts,
    prepare,
    read_episode,
    record,
    replay,
    run,
    write_episode,
)
from explicable.execution.records import Replay
from explicable.search import Outcome


@pytest.fixture(scope="module")
def recorded():
    problem = hospital()
    observable = observable_facts(problem)
    setting = prepare(problem, observable)
    truth = setting.truth

    def plan(situation):
        way = truth.mission_way(situation.state) or ()
        return Proposal(Outcome.SOLVED, tuple(map(truth.task.action, way)))

    person = SimulatedPerson(
        setting, Participant("simulated-1", readiness=0.5, learning=0.5), np.random.default_rng(3)
    )
    played = run(setting, plan, person)
    return record(played, truth.task, observable=observable, map_text="@*\n", notes={"seed": 3})


def test_a_record_survives_its_file_and_replays_exactly(recorded, tmp_path):
    write_episode(tmp_path / "game.jsonl", recorded)
    restored = read_episode(tmp_path / "game.jsonl")
    assert restored == recorded
    replayed = replay(restored)
    assert isinstance(replayed, Replay)
    assert replayed.differences == ()
    assert replayed.course.has_reached_goal


def edited(recorded, tmp_path, number, **changes):
    path = tmp_path / "game.jsonl"
    write_episode(path, recorded)
    lines = path.read_text().splitlines()
    lines[number] = json.dumps(json.loads(lines[number]) | changes)
    path.write_text("\n".join(lines))
    return path


def test_a_record_that_was_tampered_with_does_not_replay(recorded, tmp_path):
    lines = [event.notice.event.value for event in recorded.events]
    finished = lines.index("step finished") + 1
    answered = lines.index("answer given") + 1
    for path in (
        edited(recorded, tmp_path, finished, digest="0" * 16),
        edited(recorded, tmp_path, finished, action="(go robo hall attic)"),
        edited(recorded, tmp_path, finished, event="step failed"),
        edited(recorded, tmp_path, 1, state="failed"),
        edited(recorded, tmp_path, answered, answer=not recorded.events[answered - 1].notice.answer),
        edited(recorded, tmp_path, 0, deviations=99),
    ):
        assert replay(read_episode(path)).differences


@pytest.mark.parametrize(
    ("number", "changes", "message"),
    [
        (0, {"version": 2}, "version 2"),
        (0, {"version": True}, "version"),
        (0, {"format": "explicable-trace"}, "not an episode"),
        (0, {"deviations": -1}, "deviations"),
        (0, {"trace": {}}, "trace: not a trace"),
        (0, {"observable": ["clear"]}, "observable"),
        (0, {"planning_s": ["soon"]}, "planning_s"),
        (0, {"colour": "red"}, "'colour'"),
        (3, {"event": "earthquake"}, "earthquake"),
        (3, {"state": "asleep"}, "asleep"),
        (3, {"time": -1}, "time"),
        (3, {"time": 1e300}, "time"),
        (3, {"answer": "yes"}, "answer"),
        (3, {"facts": [["at"]]}, "facts"),
        (3, {"facts": ["(not clear)"]}, ""),
        (3, {"plan": ["(go"]}, "plan"),
    ],
)
def test_a_damaged_record_is_refused_with_its_line(recorded, tmp_path, number, changes, message):
    path = edited(recorded, tmp_path, number, **changes)
    if changes == {"facts": ["(not clear)"]}:  # an atom of a strange predicate, which replaying refuses
        assert read_episode(path).events[number - 1].notice.facts
        return
    with pytest.raises(EpisodeError, match=message) as caught:
        read_episode(path)
    assert caught.value.line == number + 1


@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(junk=st.binary(max_size=60), number=st.integers(0, 5))
def test_junk_is_refused(recorded, tmp_path, junk, number):
    path = tmp_path / "junk.jsonl"
    write_episode(path, recorded)
    lines = path.read_bytes().splitlines()
    lines[number] = b"[" + junk
    path.write_bytes(b"\n".join(lines))
    with pytest.raises(EpisodeError):
        read_episode(path)

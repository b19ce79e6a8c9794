"""Labels of more than two kinds: annotators who name the task that a step serves."""

from dataclasses import replace

import numpy as np
import pytest
from small_teams import first_response, walk

from explicable.errors import TraceError
from explicable.labelling.features import TeamFeatures
from explicable.labelling.labeller import Labeller
from explicable.labelling.traces import LabelledStep, Trace, read_traces, write_traces
from explicable.model.grounding import ground_team


@pytest.fixture(scope="module")
def problem():
    return first_response("hidden")


@pytest.fixture(scope="module")
def team(problem):
    return TeamFeatures(ground_team(problem))


def named(row):
    """The task, as an annotator might name it: visits search, moves that lead on approach."""
    if any(name.startswith("step: visit-room") for name in row):
        return "search"
    return "approach" if "request: move nearer" in row else False


@pytest.fixture(scope="module")
def traces(problem, team):
    rng, traces = np.random.default_rng(0), []
    for number in range(24):
        operators, states = walk(team.task, rng, 20)
        steps = [
            LabelledStep(
                problem.agent_of(team.task.action(o)).name, team.task.action(o), named(row) if row else None
            )
            for o, row in zip(operators, team.extract(operators, states), strict=True)
        ]
        traces.append(Trace(problem, tuple(steps), ("anna", "ben")[number % 2], "simulated"))
    return traces


def two_kinds(trace):
    return replace(trace, steps=tuple(replace(s, label=s.is_explicable) for s in trace.steps))


def test_names_count_as_explicable_in_every_score(traces, team):
    by_name = Labeller.train(traces, c2=0.1, num_bootstrap=3)
    plain = Labeller.train([two_kinds(trace) for trace in traces], c2=0.1, num_bootstrap=3)
    plan, same = (labeller.label(team, traces[0].actions) for labeller in (by_name, plain))
    assert plan.probabilities == same.probabilities
    assert plan.scores == same.scores
    assert plan.interval() == same.interval()
    assert same.task_labels == same.labels


def test_the_task_of_a_step_is_told(traces, team):
    labeller = Labeller.train(traces[:16], c2=0.1, num_bootstrap=0)
    right = []
    for trace in traces[16:]:
        told = labeller.label(team, trace.actions).task_labels
        assert all(label is True for label, step in zip(told, trace.steps, strict=True) if step.label is None)
        right += [
            label == step.label
            for label, step in zip(told, trace.steps, strict=True)
            if step.label is not None
        ]
    assert np.mean(right) > 0.95


def test_both_files_keep_the_names(traces, team, tmp_path):
    write_traces(tmp_path / "traces.jsonl", traces)
    again = read_traces(tmp_path / "traces.jsonl")
    assert [trace.steps for trace in again] == [trace.steps for trace in traces]
    labeller = Labeller.train(traces, num_bootstrap=2)
    labeller.save(tmp_path / "labeller.json")
    loaded = Labeller.load(tmp_path / "labeller.json")
    assert (
        loaded.label(team, traces[0].actions).task_labels
        == labeller.label(team, traces[0].actions).task_labels
    )
    assert loaded.task_model.classes_ == (True, "approach", "search", False)


@pytest.mark.parametrize("label", ["false", "True", "no", "?", "", " "])
def test_answers_put_in_quotes_are_no_names(traces, tmp_path, label):
    path = tmp_path / "traces.jsonl"
    write_traces(path, traces[:1])
    text = path.read_text().replace('"label": false', f'"label": "{label}"', 1)
    path.write_text(text)
    with pytest.raises(TraceError, match="true, false or null, or name a task"):
        read_traces(path)

"""The labeller learns, says how sure it is, survives its file, and refuses what is damaged or foreign."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from small_teams import courier, first_response, random_trace, walk

from explicable.errors import LabellerError, PlanError, TraceError, UsageError
from explicable.labelling.features import TeamFeatures
from explicable.labelling.labeller import Labeller
from explicable.labelling.labeller_file import checksum
from explicable.labelling.traces import LabelledStep, Trace
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import format_domain, format_problem, parse_domain, parse_problem


@pytest.fixture(scope="module")
def problem():
    return first_response("hidden")


@pytest.fixture(scope="module")
def team(problem):
    return ground_team(problem)


def judged_walks(problem, team, rng, num_traces, names=("anna", "ben", "cleo")):
    """Random walks; a step is explicable unless it leads away from what was asked for last."""
    features = TeamFeatures(team)
    traces = []
    for number in range(num_traces):
        operators, states = walk(team.task, rng, 20)
        rows = features.extract(operators, states)
        steps = [
            LabelledStep(
                problem.agent_of(team.task.action(o)).name,
                team.task.action(o),
                None if not row else "request: move farther" not in row,
            )
            for o, row in zip(operators, rows, strict=True)
        ]
        traces.append(Trace(problem, tuple(steps), names[number % len(names)], "simulated"))
    return traces


@pytest.fixture(scope="module")
def labeller(problem, team):
    return Labeller.train(judged_walks(problem, team, np.random.default_rng(0), 30), c2=0.1, num_bootstrap=8)


def test_learns_the_rule_on_another_map(labeller):
    other = first_response("two robots", "exclusive")
    team = ground_team(other)
    for trace in judged_walks(other, team, np.random.default_rng(1), 5):
        plan = labeller.label(team, trace.actions)
        asked = [step.label is not None for step in trace.steps]
        right = [p == s.label for p, s in zip(plan.labels, trace.steps, strict=True) if s.label is not None]
        assert np.mean(right) > 0.95
        assert list(plan.is_robot) == asked
        assert all(p == 1 for p, robot in zip(plan.probabilities, asked, strict=True) if not robot)
        low, high = plan.interval(0.95)
        grain = 1 / sum(plan.is_robot)  # counts are whole numbers
        assert low - grain <= plan.scores.f_robot_expected <= high + grain
        narrow = plan.interval(0.5)
        assert low <= narrow[0] <= narrow[1] <= high
        assert plan.distribution.sum() == pytest.approx(1)


def test_training_is_deterministic(problem, team, labeller, tmp_path):
    again = Labeller.train(judged_walks(problem, team, np.random.default_rng(0), 30), c2=0.1, num_bootstrap=8)
    labeller.save(tmp_path / "a.json")
    again.save(tmp_path / "b.json")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_file_round_trip_is_exact(labeller, team, problem, tmp_path):
    path = tmp_path / "labeller.json"
    labeller.save(path)
    loaded = Labeller.load(path)
    loaded.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == path.read_bytes()
    actions = random_trace(problem, np.random.default_rng(3), 15, team=team).actions
    first, second = labeller.label(team, actions), loaded.label(team, actions)
    assert first.probabilities == second.probabilities
    assert first.distribution.tolist() == second.distribution.tolist()


def test_any_flipped_byte_is_noticed(labeller, tmp_path):
    path = tmp_path / "labeller.json"
    labeller.save(path)
    original = path.read_bytes()
    before = json.loads(original)
    rng = np.random.default_rng(0)
    for _ in range(200):
        damaged = bytearray(original)
        damaged[rng.integers(len(damaged))] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)
        try:
            Labeller.load(path)
        except LabellerError:
            continue
        assert json.loads(bytes(damaged)) == before  # such as a space that became a line break


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"format": "x"}, "not a labeller file"),
        ({"version": 1}, "version 1"),
        ({"templates": 99}, "templates 99"),
        ({"labels": ["inexplicable", "explicable"]}, "labels"),
        ({"features": ["a", "a"]}, "rows|twice"),
        ({"model": {"weights": [], "transitions": [[0, 0], [0, 0]]}}, "rows"),
        ({"model": 3}, "weights"),
        ({"bootstrap": 3}, "bootstrap"),
        ({"extra": 3}, "unknown key 'extra'"),
    ],
)
def test_what_is_wrong_is_said_even_with_a_fitting_checksum(labeller, tmp_path, change, message):
    path = tmp_path / "labeller.json"
    labeller.save(path)
    content = json.loads(path.read_text())
    del content["sha256"]
    content |= change
    path.write_text(json.dumps(content | {"sha256": checksum(content)}))
    with pytest.raises(LabellerError, match=message) as caught:
        Labeller.load(path)
    assert caught.value.path == path


@pytest.mark.parametrize("weight", ["NaN", "Infinity", "1e999", "1e300", "true", '"1"', "null"])
def test_weights_that_are_no_finite_numbers_are_refused(labeller, tmp_path, weight):
    path = tmp_path / "labeller.json"
    labeller.save(path)
    content = json.loads(path.read_text())
    content["model"]["transitions"][0][0] = "here"
    path.write_text(json.dumps(content).replace('"here"', weight))
    with pytest.raises(LabellerError):
        Labeller.load(path)


@pytest.mark.parametrize(("part", "weight"), [("weights", 1e14), ("transitions", -301), ("weights", 10**400)])
def test_weights_that_the_core_cannot_count_with_are_refused(labeller, tmp_path, part, weight):
    path = tmp_path / "labeller.json"
    labeller.save(path)
    content = json.loads(path.read_text())
    del content["sha256"]
    content["model"][part][0][0] = weight
    path.write_text(json.dumps(content | {"sha256": checksum(content)}))
    with pytest.raises(LabellerError, match=f"a row of '{part}'"):
        Labeller.load(path)


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"[]", b"[" * 100_000, b"pickle"])
def test_foreign_files_are_refused(tmp_path, content):
    path = tmp_path / "labeller.json"
    path.write_bytes(content)
    with pytest.raises(LabellerError, match="not a labeller file"):
        Labeller.load(path)


def test_names_of_objects_make_no_difference(labeller, team, problem):
    def rename(text):
        for name in sorted({**problem.robot.objects}, key=len, reverse=True):
            text = text.replace(f"{name} ", f"{name}-x ").replace(f"{name})", f"{name}-x)")
            text = text.replace(f"{name}\n", f"{name}-x\n")
        return text

    domain = parse_domain(format_domain(problem.robot.domain))
    robot = parse_problem(rename(format_problem(problem.robot)), domain)
    human = parse_problem(rename(format_problem(problem.human)), domain)
    other = ground_team(TeamProblem(robot, human))
    actions = random_trace(problem, np.random.default_rng(5), 20, team=team).actions
    renamed = [(schema, *(f"{name}-x" for name in names)) for schema, *names in actions]
    first, second = labeller.label(team, actions), labeller.label(other, renamed)
    assert first.features == second.features
    assert first.probabilities == second.probabilities


def test_foreign_domain_is_refused_and_unknown_schemas_are_listed(labeller, problem):
    assert labeller.unknown_schemas(problem) == ()
    with pytest.raises(LabellerError, match="another domain"):
        labeller.label(ground_team(courier()), [])
    with pytest.raises(LabellerError, match="another domain"):
        labeller.scorer(ground_team(courier()))


def test_explanation_names_what_speaks_against_a_step(labeller, team):
    plan = labeller.label(
        team,
        [("command", "person", "c-1-4"), ("move", "r1", "c-1-1", "c-2-1"), ("move", "r1", "c-2-1", "c-1-1")],
    )
    assert plan.labels == (True, False, True)
    command, detour, _ = labeller.explain(plan, 3)
    assert command == []
    assert len(detour) == 3
    assert any("the request: farther" in text and weight < 0 for text, weight in detour)


def test_annotators_who_disagree_make_intervals_wider(problem, team):
    traces = judged_walks(problem, team, np.random.default_rng(0), 30)
    lenient = [
        replace(t, steps=tuple(replace(s, label=s.label is not None or None) for s in t.steps))
        if t.annotator == "ben"
        else t
        for t in traces
    ]
    names = ("anna", "ben", "cleo")
    mixed = [replace(trace, annotator=names[n // 3 % 3]) for n, trace in enumerate(lenient)]
    widths = []
    for training in (mixed, lenient):  # the same labels; the second lays what differs at one annotator's door
        labeller = Labeller.train(training, c2=0.1, num_bootstrap=30)
        low, high = zip(*(labeller.label(team, t.actions).interval() for t in traces[:6]), strict=True)
        widths.append(np.mean(high) - np.mean(low))
    assert widths[1] > widths[0]


def test_bad_training_data(problem):
    with pytest.raises(UsageError, match="nothing to learn"):
        Labeller.train([])
    unlabelled = Trace(problem, (LabelledStep("r1", ("move", "r1", "c-1-1", "c-2-1")),), "anna", "person")
    with pytest.raises(UsageError, match="nothing to learn"):
        Labeller.train([unlabelled])
    impossible = Trace(problem, (LabelledStep("r1", ("move", "r1", "c-2-1", "c-1-1"), True),), "a", "person")
    with pytest.raises(TraceError) as caught:
        Labeller.train([unlabelled, impossible])
    assert caught.value.line == 2
    with pytest.raises(UsageError, match="negative"):
        Labeller.train([], num_bootstrap=-1)


def test_labels_all_alike_give_such_labels(problem, team):
    step = LabelledStep("r1", ("move", "r1", "c-1-1", "c-2-1"), True)
    labeller = Labeller.train([Trace(problem, (step,), "anna", "person")], num_bootstrap=3)
    assert labeller.label(team, [step.action]).labels == (True,)
    assert labeller.label(team, []).labels == ()
    with pytest.raises(PlanError):
        labeller.label(team, [("move", "r1", "c-2-1", "c-1-1")])


def test_what_no_trace_showed_speaks_against_a_step(problem, team):
    traces = judged_walks(problem, team, np.random.default_rng(0), 30)
    other = ground_team(first_response("two robots", "exclusive"))
    operators, _ = walk(other.task, np.random.default_rng(3), 60)
    plan = [other.task.action(operator) for operator in operators]
    blind = [trace for trace in traces if all(step.action[0] != "remove-obstacle" for step in trace.steps)]
    means = []
    for doubt in (0.0, 0.3, 3.0):
        labeller = Labeller.train(blind[:3], num_bootstrap=2, doubt=doubt)
        labelled = labeller.label(other, plan)
        assert any(labelled.unfamiliar)
        assert labeller.summary["doubt"] == doubt
        means.append(labelled.scores.f_robot_expected)
        for said, unfamiliar in zip(labeller.explain(labelled, 100), labelled.unfamiliar, strict=True):
            weight = dict(said).get("no trace showed the like", 0.0)
            assert weight <= 0
            assert (weight < 0) == (unfamiliar and doubt > 0)
    assert means[0] > means[1] > means[2]


@pytest.mark.parametrize("doubt", [-0.1, math.inf, math.nan])
def test_doubt_must_be_a_price(problem, team, doubt):
    with pytest.raises(UsageError, match="doubt"):
        Labeller.train(judged_walks(problem, team, np.random.default_rng(0), 2), doubt=doubt)

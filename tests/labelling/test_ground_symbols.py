"""The faithful option: ground symbols and permuted copies, from training to search; where it cannot apply."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from small_teams import COURIER, COURIER_PROBLEM, MAPS, courier, first_response, random_trace, walk

from explicable.errors import LabellerError, UsageError
from explicable.first_response.encoding import encode
from explicable.first_response.map_file import parse_map
from explicable.labelling.augment import ground_symbol_features
from explicable.labelling.features import TeamFeatures
from explicable.labelling.labeller import Labeller
from explicable.labelling.learning import TrainingData
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import format_domain, format_problem, parse_domain, parse_problem
from explicable.planning import plan_explicably


@pytest.fixture(scope="module")
def problem():
    return first_response("hidden")


@pytest.fixture(scope="module")
def team(problem):
    return TeamFeatures(ground_team(problem))


@pytest.fixture(scope="module")
def traces(problem, team):
    rng = np.random.default_rng(0)
    return [random_trace(problem, rng, 15, name, team.team) for name in ("anna", "ben", "cleo") * 4]


@pytest.fixture(scope="module")
def labeller(traces):
    return Labeller.train(traces, symbols="ground", num_copies=5, num_bootstrap=3)


def test_copies_are_renamed_alike_within_a_problem_and_keep_their_labels(traces):
    data = TrainingData("ground", 4, np.random.default_rng(3))
    for trace in traces:
        data.add(trace)
    rows, labels = list(data.sequences()), list(data.answers())
    assert len(rows) == len(labels) == data.num_sequences == 5 * len(traces)
    assert rows[::5] == data.features
    assert labels[::5] == labels[4::5] == data.labels
    for place, trace in enumerate(traces):
        for actions, row in zip(trace.actions, data.features[place], strict=True):
            assert row == (() if actions[0] == "command" else tuple(*ground_symbol_features([actions])))
    assert all([not r for r in row] == [not r for r in rows[n // 5 * 5]] for n, row in enumerate(rows))
    assert sum(copy != rows[n // 5 * 5] for n, copy in enumerate(rows) if n % 5) > 3 * len(traces)


def test_the_file_keeps_it(labeller, team, traces, tmp_path):
    labeller.save(tmp_path / "labeller.json")
    loaded = Labeller.load(tmp_path / "labeller.json")
    assert loaded.symbols == "ground"
    assert loaded.label(team, traces[0].actions) == labeller.label(team, traces[0].actions)
    loaded.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "labeller.json").read_bytes()


@pytest.mark.parametrize("expected", [True, False])
def test_the_search_counts_as_the_labels_do(labeller, team, expected):
    rng = np.random.default_rng(1)
    scorer = labeller.scorer(team, expected=expected)
    for _ in range(20):
        operators, states = walk(team.task, rng, 12)
        plan = labeller.label(team, [team.task.action(o) for o in operators])
        context = scorer.root(states[0])
        for place, operator in enumerate(operators):
            context = scorer.extend(context, operator, states[place], states[place + 1])
        scores = plan.scores.paper
        explicable = scores.expected if expected else scores.by_labels
        assert scorer.score(context, states[-1], [])[0] == pytest.approx(len(operators) * (1 - explicable))


def test_a_plan_is_made_with_it_on_another_map_with_the_same_names(labeller):
    other = ground_team(first_response("two robots"))
    found = plan_explicably(other, labeller, improve_s=0)
    assert found.plan is not None
    assert other.task.is_goal(other.task.execute(found.plan.actions).states[-1])


def test_names_that_it_has_never_seen_are_refused(labeller, problem):
    def rename(text):
        for name in sorted(problem.robot.objects, key=len, reverse=True):
            text = text.replace(f"{name} ", f"{name}-x ").replace(f"{name})", f"{name}-x)")
            text = text.replace(f"{name}\n", f"{name}-x\n")
        return text

    domain = parse_domain(format_domain(problem.robot.domain))
    stranger = ground_team(TeamProblem(parse_problem(rename(format_problem(problem.robot)), domain)))
    for use in (lambda: labeller.label(stranger, []), lambda: labeller.scorer(stranger)):
        with pytest.raises(LabellerError, match="none of the objects"):
            use()
    with pytest.raises(LabellerError, match="another domain"):
        labeller.label(ground_team(courier()), [])


def test_lifted_features_take_no_copies(traces):
    with pytest.raises(UsageError, match="ground symbols"):
        Labeller.train(traces, num_copies=3)
    with pytest.raises(UsageError, match="at least 0"):
        Labeller.train(traces, symbols="ground", num_copies=-1)


def test_lifted_features_lose_nothing_on_unseen_names_where_ground_symbols_do(problem, team):
    """Where the cells have other numbers, the same play gets the same labels from lifted features only."""
    moved = encode(parse_map("".join(f"#{row}\n" for row in ("#" * 6, *MAPS["hidden"]))))  # shifts every cell
    there = TeamFeatures(ground_team(moved))
    shift = {
        name: f"c-{int(name.split('-')[1]) + 1}-{int(name.split('-')[2]) + 1}"
        for name in problem.robot.objects
        if name.startswith("c-")
    }
    rng = np.random.default_rng(2)
    traces = [random_trace(problem, rng, 20, name, team.team) for name in ("anna", "ben") * 6]
    # The person dislikes whatever happens on the left: a rule about names.
    judged = [
        replace(t, steps=tuple(replace(s, label=s.action[-1][-1] > "2") for s in t.steps)) for t in traces
    ]
    lifted = Labeller.train(judged, num_bootstrap=0)
    ground = Labeller.train(judged, num_bootstrap=0, symbols="ground")
    plan = traces[0].actions
    renamed = [(schema, *(shift.get(name, name) for name in names)) for schema, *names in plan]
    assert lifted.label(team, plan).probabilities == lifted.label(there, renamed).probabilities
    assert ground.label(team, plan).probabilities != ground.label(there, renamed).probabilities


def test_an_action_may_be_named_unfamiliar():
    domain = parse_domain(COURIER.replace("(:action go", "(:action unfamiliar"))
    problem = TeamProblem(parse_problem(COURIER_PROBLEM.format(lift=""), domain))
    features = TeamFeatures(ground_team(problem))
    traces = [
        random_trace(problem, np.random.default_rng(seed), 15, "anna", features.team) for seed in (1, 2)
    ]
    labeller = Labeller.train(traces, symbols="ground", num_bootstrap=0)
    scorer = labeller.scorer(features)
    for trace in traces:
        labelled = labeller.label(features, trace.actions)
        assert any(action[0] == "unfamiliar" for action in trace.actions)
        assert not any(labelled.unfamiliar)
        execution = features.task.execute(trace.actions)
        context = scorer.root(execution.states[0])
        for operator, (before, after) in zip(execution.operators, pairwise(execution.states), strict=True):
            context = scorer.extend(context, operator, before, after)
        expected = len(trace.steps) * (1 - labelled.scores.f_expected)
        assert scorer.score(context, execution.states[-1], [])[0] == pytest.approx(expected)

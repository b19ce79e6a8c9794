"""Features: progress against a slow oracle, requests by their definition, and what templates promise."""

import math

import numpy as np
import pytest
from small_teams import first_response, problems, walk

from explicable.first_response.encoding import encode
from explicable.first_response.generator import generate
from explicable.labelling.features import TeamFeatures
from explicable.labelling.templates import PROGRESS, TEMPLATES, explain_feature, feature_code
from explicable.model.grounding import ground_team
from oracles import progress as oracle


@pytest.fixture(scope="module", params=problems())
def team(request):
    return TeamFeatures(ground_team(problems()[request.param]))


def is_human(team):
    return lambda task, operator: team.team.problem.agent_of(task.action(operator)).kind == "human"


def robot_operators(team):
    return [o for o in range(team.task.num_operators) if not team.tables.is_human(o)]


def test_progress_toward_requests_equals_the_oracle(team):
    for request, facts in enumerate(team.tables.request_facts):
        atoms = set(map(team.task.fact, facts))
        mental, own = (oracle.to_request(t, atoms, is_human(team)) for t in (team.team.mental, team.task))
        for operator in robot_operators(team):
            expected = tuple(oracle.toward_request(team, operator, d) for d in (mental, own))
            if request in team.tables.fulfils(operator):
                expected = ("done", "done")
            got = tuple(PROGRESS[p] for p in team.tables.toward_request(operator, request))
            assert got == expected, (atoms, team.task.action(operator))


def test_progress_toward_goals_equals_the_oracle(team):
    goals = [team.task.fact(fact) for fact in team.task.goal]
    mental = {goal: oracle.to_goal(team.team.mental, goal) for goal in goals}
    own = {goal: oracle.to_goal(team.task, goal) for goal in goals}
    for open_goals in oracle.itertools.product([False, True], repeat=len(goals)):
        fulfilled = [not is_open for is_open in open_goals]
        left = [goal for goal, is_open in zip(goals, open_goals, strict=True) if is_open]
        for operator in robot_operators(team):
            got = tuple(PROGRESS[p] for p in team.tables.toward_goals(operator, fulfilled))
            adds = oracle.added(team.task, operator)
            if not left:
                assert got == ("no-target",) * 3
            elif adds.intersection(left):
                assert got == ("done",) * 3
            else:
                nearest = [
                    oracle.toward_goals(team, operator, {g: d[g] for g in left}, lambda _: 0)
                    for d in (mental, own)
                ]
                assert got[:2] == tuple(nearest), (left, team.task.action(operator))
                tour = oracle.toward_goals(team, operator, {g: mental[g] for g in left}, rest(team, mental))
                assert got[2] == tour, (left, team.task.action(operator))


@pytest.mark.parametrize("num_goals", [12, 60, 70])
def test_progress_toward_many_goals_is_that_toward_the_nearest(num_goals):
    """Above ten goals no order is looked for; up to 48 answers are kept; up to 64 one word holds them."""
    world = generate(
        np.random.default_rng(num_goals), height=12, width=12, num_marks=num_goals, num_hidden=12
    )
    team = TeamFeatures(ground_team(encode(world)))
    goals = [team.task.fact(fact) for fact in team.task.goal]
    distances = [{g: oracle.to_goal(t, g) for g in goals} for t in (team.team.mental, team.task)]
    rng = np.random.default_rng(0)
    operators = robot_operators(team)
    for share in (0.0, 0.5, 0.9, 1.0):
        fulfilled = [bool(x < share) for x in rng.random(len(goals))]
        left = [goal for goal, done in zip(goals, fulfilled, strict=True) if not done]
        for operator in map(int, rng.choice(operators, 40)):
            got = tuple(PROGRESS[p] for p in team.tables.toward_goals(operator, fulfilled))
            adds, uses = oracle.added(team.task, operator), oracle.used_up(team.task, operator)
            if not left or adds.intersection(left):
                assert got == ("done" if left else "no-target",) * 3
                continue
            mental, own = (
                oracle.judge(
                    *(
                        min((d[g].get(f, math.inf) for f in facts for g in left), default=math.inf)
                        for facts in (uses, adds)
                    )
                )
                for d in distances
            )
            assert got == (mental, own, mental), (left, team.task.action(operator))


def rest(team, mental):
    """What an order of goals costs after its first, each begun where the one before leaves off."""

    def between(first, second):
        achievers = [o for o in range(team.task.num_operators) if first in oracle.added(team.task, o)]
        left = [
            fact
            for o in achievers
            for fact in (oracle.needs(team.task, o) - deleted(team.task, o)) | oracle.added(team.task, o)
        ]
        steps = min((mental[second].get(fact, math.inf) for fact in left), default=math.inf)
        return 0 if steps == math.inf else steps

    return lambda order: sum(between(a, b) for a, b in oracle.itertools.pairwise(order))


def deleted(task, operator):
    return {task.fact(fact) for fact in task.core.deletes(operator)}


def test_only_commands_to_different_rooms_are_different_requests():
    for semantics in ("persistent", "exclusive"):
        team = TeamFeatures(ground_team(first_response("two robots", semantics)))
        atoms = {team.task.fact(fact) for facts in team.tables.request_facts for fact in facts}
        assert atoms == {("commanded", room) for room in ("c-1-3", "c-3-1", "c-3-5")}


def features_of(team, plan):
    execution = team.task.execute(plan)
    return team.extract(execution.operators, execution.states)


def test_the_latest_unfulfilled_request_is_the_target():
    team = TeamFeatures(ground_team(first_response("hidden")))
    first, second = ("command", "person", "c-3-1"), ("command", "person", "c-1-4")
    south, visit = ("move", "r1", "c-1-1", "c-2-1"), ("visit-room", "r1", "c-3-1")
    down = ("move", "r1", "c-2-1", "c-3-1")
    up = ("move", "r1", "c-3-1", "c-2-1")
    assert "request: move nearer" in features_of(team, [first, south])[1]
    assert "request: move farther" in features_of(team, [first, second, south])[2]
    assert "request: move nearer" in features_of(team, [second, first, south])[2]
    rows = features_of(team, [second, first, south, down, visit, up])
    assert "request: visit-room done" in rows[4]
    assert "request: move nearer" in rows[5]  # back to the older request
    assert "outlook: nearer human-step" in features_of(team, [second, south, down, up, first])[3]


def test_a_new_exclusive_command_withdraws_the_old():
    team = TeamFeatures(ground_team(first_response("hidden", "exclusive")))
    first, second = ("command", "person", "c-1-4"), ("command", "person", "c-3-1")
    way = [("move", "r1", "c-1-1", "c-2-1"), ("move", "r1", "c-2-1", "c-3-1"), ("visit-room", "r1", "c-3-1")]
    back = ("move", "r1", "c-3-1", "c-2-1")
    rows = features_of(team, [first, second, *way, ("command", "person", "c-1-4"), back])
    assert "request: visit-room done" in rows[4]
    assert "request: move nearer" in rows[6]
    assert "returns: move" in rows[6]


def test_features_look_one_step_ahead_and_no_further(team):
    rng = np.random.default_rng(0)
    for _ in range(20):
        operators, states = walk(team.task, rng, 12)
        whole = team.extract(operators, states)
        for end in range(1, len(operators)):
            part = team.extract(operators[: end + 1], states[: end + 2])
            assert part[:end] == whole[:end]


def test_every_feature_has_a_code_of_its_own_and_a_text(team):
    rng = np.random.default_rng(0)
    schemas = {name: number for number, name in enumerate(team.schemas)}
    codes = {}
    for _ in range(30):
        operators, states = walk(team.task, rng, 12)
        for feature in {name for row in team.extract(operators, states) for name in row}:
            code = feature_code(feature, schemas, team.tables.max_arity)
            assert code is not None
            assert codes.setdefault(code, feature) == feature
            assert explain_feature(feature) != feature
            assert not any(name in feature.split(" ") for name in team.task.objects)
    assert {list(TEMPLATES)[template] for template, _ in codes} >= {"step", "after", "request", "outlook"}
    for foreign in ("", "step", "step: fly", "nonsense: move", "request: move sideways", "same-after: move"):
        assert feature_code(foreign, schemas, team.tables.max_arity) is None

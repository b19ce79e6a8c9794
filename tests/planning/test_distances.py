"""Distances are distances; each against its formula by hand."""

import numpy as np
import pytest

from explicable.errors import PlanError
from explicable.model.grounding import ground_team
from explicable.planning.distances import GOAL, INIT, causal_links, plan_distance
from labelling.small_teams import courier, walk
from planning.floors import DETOUR, command, floor, moves, visit

EXPECTED = [command(1, 3), *moves((1, 1), (1, 2), (1, 3)), visit(1, 3)]
DETOURING = [command(1, 3), *moves((1, 1), (2, 1), (2, 2), (2, 3), (1, 3)), visit(1, 3)]


def test_the_detour_by_hand():
    team = floor(DETOUR)
    distance = plan_distance(team, DETOURING, EXPECTED)
    assert distance.actions == pytest.approx(1 - 2 / 8)
    # States agree after the command only; the last pair is (at the room, visited) against two steps less.
    own, theirs = team.task.execute(DETOURING), team.mental.execute(EXPECTED)
    common = 0
    for one, other in zip(own.states[1:], theirs.states[1:], strict=False):
        s = team.task.atoms(one)
        t = team.mental.atoms(other) - {("at", "r1", "c-1-2")}  # no fact in truth
        common += len(s & t) / len(s | t)
    assert distance.states == pytest.approx(1 - common / 6)


def test_causal_links_by_hand():
    team = floor("####\n#@*#\n####\n")
    plan = [command(1, 2), *moves((1, 1), (1, 2)), visit(1, 2)]
    links = causal_links(team.task, team.task.execute(plan))
    move, visited = plan[1], ("visited", "c-1-2")
    assert (INIT, ("at", "r1", "c-1-1"), move) in links
    assert (move, ("at", "r1", "c-1-2"), plan[2]) in links
    assert (plan[2], visited, GOAL) in links


def test_distances_lie_between_same_and_one():
    team = ground_team(courier())
    rng = np.random.default_rng(1)
    for length in (0, 1, 4, 9):
        own = [team.task.action(o) for o in walk(team.task, rng, length)[0]]
        theirs = [team.mental.action(o) for o in walk(team.mental, rng, 6)[0]]
        same = plan_distance(team, own, own)
        other = plan_distance(team, own, theirs)
        assert (same.actions, same.causal_links, same.states) == (0, 0, 0)
        for value in (other.actions, other.causal_links, other.states):
            assert 0 <= value <= 1


def test_an_expected_plan_must_be_one_of_the_mental_model():
    with pytest.raises(PlanError, match="step 2"):
        plan_distance(floor(DETOUR), DETOURING, [command(1, 3), *moves((2, 1), (2, 2))])

"""What the person takes the state to be, while the plan runs before their eyes."""

import numpy as np

from explicable.model.grounding import ground_team
from explicable.planning.beliefs import watch
from labelling.small_teams import courier, walk
from planning.floors import DETOUR, floor, moves


def test_an_impossible_step_is_taken_note_of_as_it_happens():
    # The robot drives over a cell that the person takes to be blocked: swap the two models.
    team = ground_team(floor(DETOUR).problem)
    swapped = type(team.problem)(team.problem.mental, team.problem.robot)
    watched = watch(ground_team(swapped), moves((1, 1), (1, 2), (1, 3)))
    assert watched.operators == (None, None)
    assert watched.num_impossible == 2
    assert ground_team(swapped).mental.holds(("at", "r1", "c-1-3"), watched.states[-1])
    assert watched.costs == (1, 1)


def test_what_is_seen_is_true_afterwards_whatever_was_believed():
    team = ground_team(courier())
    rng = np.random.default_rng(0)
    for _ in range(10):
        operators, states = walk(team.task, rng, 15)
        watched = watch(team, [team.task.action(operator) for operator in operators])
        for before, after, own, theirs, operator in zip(
            states, states[1:], watched.states[1:], watched.operators, operators, strict=False
        ):
            made = team.task.atoms(after) - team.task.atoms(before)
            assert all(team.mental.holds(atom, own) for atom in made)
            assert theirs is None or team.mental.action(theirs) == team.task.action(operator)

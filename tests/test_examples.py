"""The example teams: read without a warning, solvable as far as relaxation tells, and seen differently."""

from pathlib import Path

import pytest

from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import PDDLWarning, read_pair

EXAMPLES = sorted(
    path.parent for path in (Path(__file__).parents[1] / "examples").glob("*/human-problem.pddl")
)


def read_team(folder):
    warnings: list[PDDLWarning] = []
    robot = read_pair(folder / "domain.pddl", folder / "problem.pddl", warn=warnings.append)
    human = read_pair(folder / "human-domain.pddl", folder / "human-problem.pddl", warn=warnings.append)
    assert not warnings
    return TeamProblem(robot, human)


@pytest.mark.parametrize("folder", EXAMPLES, ids=lambda folder: folder.name)
def test_both_sides_can_reach_the_goal_on_their_own_ground(folder):
    team = read_team(folder)
    task = ground_team(team)
    kinds = [agent.kind for agent in team.agents]
    assert "human" in kinds
    assert kinds.count("robot") == 2
    assert task.task.goal_reachable
    assert task.mental.goal_reachable
    own, theirs = (
        {tuple(grounded.action(operator)) for operator in range(grounded.num_operators)}
        for grounded in (task.task, task.mental)
    )
    assert own < theirs  # each example's person believes in more possibilities than there are


def test_there_are_examples():
    assert [folder.name for folder in EXAMPLES] == ["rover-survey", "warehouse"]

"""What commanded play alone can't teach: a robot that moves before anybody has asked for anything."""

import pytest

from explicable.execution import builtin_families, simulate_study
from explicable.first_response import builtin_maps, encode
from explicable.labelling import Labeller
from explicable.labelling.doubt import DEFAULT_DOUBT
from explicable.model.grounding import ground_team
from explicable.planning import plan_classically


def rearranged(actions):
    """The plan with each command before the way to its room, and with each as late as it can be."""
    commands = {action[2]: action for action in actions if action[0] == "command"}
    early, late, way = [], [], []
    for action in actions:
        if action[0] == "command":
            continue
        way.append(action)
        if action[0] == "visit-room":
            early += [commands[action[2]], *way]
            late += [*way[:-1], commands[action[2]], action]
            way = []
    return [*early, *way], [*late, *way]


@pytest.fixture(scope="module")
def plans():
    world = next(iter(builtin_maps("test").values()))
    team = ground_team(encode(world))
    return team, *rearranged(plan_classically(team, algorithm="ff").plan.actions)


@pytest.mark.parametrize("seed", [1, 2])
def test_steps_without_a_request_are_labelled_worse_by_who_has_seen_some_or_doubts(plans, seed):
    team, early, late = plans
    problems = [encode(world) for world in list(builtin_maps("training").values())[:8]]
    family = builtin_families()["myopic"]
    gains = {}
    for way in ("commanded", "mixed"):
        traces = [e.trace for e in simulate_study(problems, family, num_traces=16, seed=seed, way=way)]
        for doubt in (0.0, DEFAULT_DOUBT):
            labeller = Labeller.train(traces, num_bootstrap=0, doubt=doubt)
            good, bad = (labeller.label(team, plan).scores.f_robot_expected for plan in (early, late))
            gains[way, doubt] = good - bad
    assert gains["commanded", 0.0] < gains["mixed", 0.0] / 2  # thinks little of it
    assert gains["mixed", 0.0] > 0.3
    assert gains["commanded", DEFAULT_DOUBT] > gains["mixed", 0.0] * 2 / 3


def test_one_of_four_games_surprises():
    problem = encode(builtin_maps("training")["training-01"])
    episodes = simulate_study([problem], builtin_families()["myopic"], num_traces=8, seed=3, way="mixed")
    plain = simulate_study([problem], builtin_families()["myopic"], num_traces=8, seed=3, way="commanded")
    moved_unasked = [episode.trace.steps[0].action[0] == "move" for episode in episodes]
    assert sum(moved_unasked[:4]) == sum(moved_unasked[4:]) == 1
    same = [one.trace.steps == two.trace.steps for one, two in zip(episodes, plain, strict=True)]
    assert same == [not unasked for unasked in moved_unasked]
    assert not any(episode.trace.notes["participant"]["initiative"] for episode in episodes)

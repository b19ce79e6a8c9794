"""The ceiling, against all plans judged one by one."""

from dataclasses import replace

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.evaluation.ceiling import plan_for_judges
from explicable.execution import Participant, judge, prepare
from explicable.first_response import World, encode
from oracles.plans import all_plans


def plans_of(task, max_steps):
    """Every plan, as actions, without the stage's own switches."""
    for operators in all_plans(task, max_steps, lambda action: " " not in action[0]):
        yield tuple(map(task.action, operators))


def held_against(setting, judges, actions):
    """Steps that are called inexplicable, on average over judges who learn all that they can, or nothing."""
    counts = []
    for one in judges:
        for learning in (0.0, 1.0):
            watcher = replace(one, learning=learning, memory=1.0, noise=0.0)
            steps = judge(setting, watcher, actions, np.random.default_rng(0))
            counts.append(sum(step.is_explicable is False for step in steps))
    return np.mean(counts)


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
@pytest.mark.parametrize("horizon", ["request", "mission"])
@pytest.mark.parametrize("rows", [("@x*", "..."), ("@o*", "..."), ("*@.", ".x*")])
def test_no_plan_within_the_limit_is_held_less_against_the_robot(rows, horizon, semantics):
    setting = prepare(encode(World(rows), semantics))
    judges = [Participant(f"simulated-{slack}", horizon=horizon, slack=slack) for slack in (0.0, 1.0)]
    for increase in (0.0, 0.2):
        best = plan_for_judges(setting, judges, increase)
        cheapest = len(plan_for_judges(setting, judges, 0.0))
        plans = list(plans_of(setting.truth.task, int(cheapest * (1 + increase))))
        assert len(best) <= cheapest * (1 + increase)
        least = min(held_against(setting, judges, plan) for plan in plans)
        assert held_against(setting, judges, best) == pytest.approx(least)


def test_judges_of_several_horizons_have_no_common_mind():
    setting = prepare(encode(World(("@*",))))
    with pytest.raises(UsageError, match="horizon"):
        plan_for_judges(setting, [Participant("a"), Participant("b", horizon="mission")])

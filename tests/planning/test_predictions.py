"""Convenient orders are implausible ones: the model of the person's choices sees through them."""

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.execution import builtin_families, simulate_study
from explicable.first_response import builtin_maps, encode
from explicable.model.grounding import ground_team
from explicable.planning import plan_classically
from explicable.planning.predictions import HumanModel
from labelling.small_teams import courier, problems, random_trace, walk


@pytest.fixture(scope="module")
def episodes():
    """Simulated participants on maps; those to learn from and others to predict."""
    family = builtin_families()["myopic"]
    train, test = (
        [encode(world) for world in list(builtin_maps(kind).values())[:8]] for kind in ("training", "test")
    )
    return (
        simulate_study(train, family, num_traces=16, seed=1, way="commanded"),
        simulate_study(test, family, num_traces=4, seed=2, way="commanded"),
    )


@pytest.fixture(scope="module")
def human(episodes):
    return HumanModel.learn([episode.trace for episode in episodes[0]])


def test_people_s_own_orders_are_more_plausible_than_a_planner_s(human, episodes):
    for episode in episodes[1]:
        team = ground_team(episode.trace.problem)
        lived = human.predict(team, episode.trace.actions)
        planned = human.predict(team, plan_classically(team, algorithm="lazy", seed=1).plan.actions)
        assert lived.f_human > planned.f_human
        assert lived.log_probability > planned.log_probability


def test_the_same_way_under_convenient_orders_gets_a_worse_f_human(human, episodes):
    for episode in episodes[1]:
        team, actions = ground_team(episode.trace.problem), episode.trace.actions
        orders = [action for action in actions if action[0] == "command"]
        convenient = orders + [action for action in actions if action[0] != "command"]
        assert human.predict(team, convenient).f_human < human.predict(team, actions).f_human


@pytest.mark.parametrize("name", problems())
def test_what_a_person_may_do_at_one_point_sums_to_one(name):
    problem = problems()[name]
    team, rng = ground_team(problem), np.random.default_rng(0)
    human = HumanModel.learn([random_trace(problem, rng, 20, team=team) for _ in range(5)])
    for _ in range(5):
        before = [team.task.action(operator) for operator in walk(team.task, rng, 6)[0]]
        state = team.task.execute(before).states[-1]
        options = [team.task.action(operator) for operator in team.task.applicable(state)]
        human_steps = [action for action in options if problem.agent_of(action).kind == "human"]
        acts = {action: human.predict(team, [*before, action]).probabilities[-1] for action in human_steps}
        if acts:  # what comes next, if anything: the same, given that the person acts
            whole = sum(acts.values())
            expected = {action: chance / whole for action, chance in acts.items()}
            assert human.next_steps(team, before) == pytest.approx(expected)
        total = sum(human.predict(team, [*before, action]).probabilities[-1] for action in human_steps)
        assert 0 < total < 1  # the rest is waiting
    prediction = human.predict(team, before)
    for action, p in zip(before, prediction.probabilities, strict=True):
        assert (p is None) == (problem.agent_of(action).kind == "robot")


def test_a_plan_without_human_steps_has_no_f_human():
    problem = courier()
    team, rng = ground_team(problem), np.random.default_rng(0)
    human = HumanModel.learn([random_trace(problem, rng, 20, team=team)])
    prediction = human.predict(team, [])
    assert prediction.f_human is prediction.log_probability is None


def test_traces_without_human_steps_are_refused():
    trace = random_trace(courier(), np.random.default_rng(0), 0)
    with pytest.raises(UsageError, match="no trace has a human step"):
        HumanModel.learn([trace])

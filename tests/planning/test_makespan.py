import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.first_response import World, encode, generate, parse_map
from explicable.model.durations import Durations
from explicable.model.grounding import ground, ground_team
from explicable.model.schedule import make_schedule
from explicable.model.team import Agent, TeamProblem, TeamTask
from explicable.planning.goal_orders import GoalOrders
from explicable.planning.makespan import plan_schedule, schedule_plan
from explicable.search import Outcome, search
from oracles.random_problems import ProblemMaker
from planning.floors import DETOUR, PATIENCE_S, judge_of_progress

LENGTH = 3


class Actors(TeamProblem):
    """A team in which every schema has an agent of its own."""

    @property
    def agents(self):
        return tuple(Agent(schema.name, "robot") for schema in self.robot.domain.actions)

    def agent_of(self, action):
        return Agent(action[0], "robot")


def least_makespan(team_task, durations):
    """The least of all plans of up to ``LENGTH`` steps, by trying them."""
    task, least = team_task.task, float("inf")

    def extend(actions, state):
        nonlocal least
        if task.is_goal(state):
            least = min(least, make_schedule(team_task.problem, task, actions, durations).makespan)
            return
        if len(actions) < LENGTH:
            for action in {task.action(operator) for operator in task.applicable(state)} - {()}:
                extend((*actions, action), task.execute([action], state).states[-1])

    extend((), task.initial_state)
    return least


@settings(max_examples=100)
@given(st.integers(0, 10**6), st.booleans())
def test_what_is_proved_is_the_least_makespan_of_all_plans(seed, strips):
    rng = random.Random(seed)
    problem = Actors(ProblemMaker(rng, strips=strips).problem())
    task = ground(problem.robot)
    team_task = TeamTask(problem, task, task)
    durations = Durations(schemas={agent.name: rng.choice([0.5, 1.0, 2.0]) for agent in problem.agents})
    planned = plan_schedule(team_task, durations, time_limit_s=PATIENCE_S, max_width=256)
    if planned.schedule is None:
        assert planned.outcome is Outcome.UNSOLVABLE
        assert planned.lower_bound == float("inf")
        return
    assert task.is_goal(task.execute(planned.schedule.actions).states[-1])
    least = least_makespan(team_task, durations)
    assert planned.lower_bound <= least
    if planned.is_optimal and len(planned.schedule.steps) <= LENGTH:
        assert planned.schedule.makespan == least


def test_the_proof_succeeds_on_small_maps():
    """Two robots in two corridors: the rooms are searched at the same time."""
    problem = encode(World(("@..*", "####", "*..@")), "persistent", num_people=2)
    planned = plan_schedule(
        ground_team(problem), Durations(schemas={"command": 0.5}), time_limit_s=PATIENCE_S
    )
    assert planned.is_optimal
    assert planned.schedule.makespan == 4.0
    assert {"r1", "r2"} <= set(planned.schedule.agents)


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
def test_two_robots_are_done_sooner_than_one_after_the_other(semantics):
    world = generate(np.random.default_rng(5), num_robots=2)
    team_task = ground_team(encode(world, semantics, num_people=2))
    planned = plan_schedule(team_task, time_limit_s=PATIENCE_S, max_width=16)
    task = team_task.task
    assert task.is_goal(task.execute(planned.schedule.actions).states[-1])
    assert planned.lower_bound <= planned.schedule.makespan <= len(planned.schedule.steps)
    if semantics == "persistent":
        assert planned.schedule.makespan <= 0.6 * len(planned.schedule.steps)


def test_an_unsolvable_task_and_impossible_settings():
    team_task = ground_team(encode(World(("@.*",))))
    hopeless = TeamTask(
        team_task.problem, team_task.task.with_goal([("at", "person", "c-0-0")]), team_task.mental
    )
    assert plan_schedule(hopeless).outcome is Outcome.UNSOLVABLE
    for wrong in ({"alpha": -1.0}, {"alpha": float("nan")}, {"time_limit_s": 0.0}, {"max_width": 0}):
        with pytest.raises(UsageError):
            plan_schedule(team_task, **wrong)


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
def test_plans_made_goal_by_goal_reach_the_goal_and_share_the_work(semantics):
    for seed in range(3):
        world = generate(np.random.default_rng(seed), num_robots=2)
        team_task = ground_team(encode(world, semantics, num_people=2))
        task, durations = team_task.task, Durations(schemas={"visit-room": 3.0})
        plans = list(GoalOrders(team_task, durations, lambda: False).plans())
        assert len(plans) > 1
        for plan in plans:
            assert task.is_goal(task.execute(plan).states[-1])
        one_by_one = schedule_plan(team_task, tuple(map(task.action, search(task).operators)), durations)
        planned = plan_schedule(team_task, durations, time_limit_s=PATIENCE_S, max_width=4)
        least = min(schedule_plan(team_task, plan, durations).schedule.makespan for plan in plans)
        assert planned.schedule.makespan <= min(least, one_by_one.schedule.makespan)


def test_goals_that_are_no_atoms_or_a_single_robot_are_left_to_the_beams():
    alone = ground_team(encode(World(("@.*", "..*"))))
    assert not list(GoalOrders(alone, Durations(), lambda: False).plans())


def test_a_labeller_has_its_say_in_which_schedule_is_taken():
    problem = encode(parse_map(DETOUR))
    team_task, labeller = ground_team(problem), judge_of_progress()
    planned = plan_schedule(team_task, labeller=labeller, alpha=2.0, time_limit_s=PATIENCE_S, max_width=64)
    assert planned.labelled.actions == planned.schedule.actions
    num_inexplicable = len(planned.schedule.steps) * (1.0 - planned.labelled.scores.f_expected)
    assert planned.objective == pytest.approx(planned.schedule.makespan + 2.0 * num_inexplicable)
    given = schedule_plan(team_task, planned.schedule.actions, labeller=labeller, alpha=2.0)
    assert given.objective == pytest.approx(planned.objective)
    careless = plan_schedule(team_task, labeller=labeller, alpha=0.0, time_limit_s=PATIENCE_S, max_width=64)
    assert careless.schedule.makespan <= planned.schedule.makespan
    assert planned.objective <= careless.schedule.makespan + 2.0 * len(careless.schedule.steps) * (
        1.0 - careless.labelled.scores.f_expected
    )

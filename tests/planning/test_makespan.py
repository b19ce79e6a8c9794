import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.first_response import World, encode, generate
from explicable.model.durations import Durations
from explicable.model.grounding import ground, ground_team
from explicable.model.schedule import make_schedule
from explicable.model.team import Agent, TeamProblem, TeamTask
from explicable.planning.makespan import plan_schedule
from explicable.search import Outcome
from oracles.random_problems import ProblemMaker

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


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.booleans())
def test_what_is_proved_is_the_least_makespan_of_all_plans(seed, strips):
    rng = random.Random(seed)  # noqa: S311
    problem = Actors(ProblemMaker(rng, strips=strips).problem())
    task = ground(problem.robot)
    team_task = TeamTask(problem, task, task)
    durations = Durations(schemas={agent.name: rng.choice([0.5, 1.0, 2.0]) for agent in problem.agents})
    planned = plan_schedule(team_task, durations, time_limit_s=0.5, max_width=256)
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
    planned = plan_schedule(ground_team(problem), Durations(schemas={"command": 0.5}))
    assert planned.is_optimal
    assert planned.schedule.makespan == 4.0
    assert {"r1", "r2"} <= set(planned.schedule.agents)


@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
def test_two_robots_are_done_sooner_than_one_after_the_other(semantics):
    world = generate(np.random.default_rng(5), num_robots=2)
    team_task = ground_team(encode(world, semantics, num_people=2))
    planned = plan_schedule(team_task, time_limit_s=2.0, max_width=64)
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

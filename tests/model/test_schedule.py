import itertools
import random

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from explicable.errors import InputError, PlanError, UsageError
from explicable.first_response import encode, generate
from explicable.model.durations import Durations, read_durations
from explicable.model.grounding import ground
from explicable.model.schedule import fact_use, make_schedule
from explicable.model.team import TeamProblem
from oracles.random_problems import ProblemMaker


def random_walk(task, rng, length):
    state, actions = task.initial_state, []
    for _ in range(length):
        operators = [o for o in task.applicable(state) if task.action(o)]
        if not operators:
            break
        # Several operators share an action where a disjunction was split: take the one that execute() takes.
        actions.append(task.action(rng.choice(operators)))
        state = task.execute(actions).states[-1]
    return actions


def random_schedule(seed, length=6):
    """A random plan of a random ADL problem, whose actors are made up."""
    rng = random.Random(seed)
    problem = ProblemMaker(rng).problem()
    task = ground(problem)
    actions = random_walk(task, rng, length)
    durations = Durations(actions={action: rng.choice([0.5, 1.0, 2.0, 3.5]) for action in actions})
    return task, actions, durations, make_schedule(Actors(problem), task, actions, durations)


class Actors(TeamProblem):
    """A team in which every schema has an agent of its own."""

    def agent_of(self, action):
        from explicable.model.team import Agent

        return Agent(action[0], "robot")


@given(st.integers(0, 10**6))
def test_every_linearisation_can_be_executed_and_ends_in_the_same_state(seed):
    task, actions, _, schedule = random_schedule(seed)
    end = task.execute(actions).states[-1]
    for order in itertools.islice(schedule.linearisations(), 200):
        assert task.execute(order).states[-1] == end


def overlapping_orders(schedule, rng):
    """Orders in which effects may come true: each step at any moment within its duration."""
    moments = [rng.uniform(scheduled.start, scheduled.end) for scheduled in schedule.steps]
    return [
        schedule.steps[number].step.action for number in sorted(range(len(moments)), key=moments.__getitem__)
    ]


@given(st.integers(0, 10**6))
def test_acting_at_once_comes_to_the_same_as_one_after_the_other(seed):
    task, actions, _, schedule = random_schedule(seed, length=8)
    end = task.execute(actions).states[-1]
    for number in range(10):
        order = overlapping_orders(schedule, random.Random(number))
        assert task.execute(order).states[-1] == end


@given(st.integers(0, 10**6))
def test_steps_that_overlap_do_not_interfere(seed):
    task, _, _, schedule = random_schedule(seed, length=8)
    states = task.execute(schedule.actions).states
    operators = task.execute(schedule.actions).operators
    uses = [fact_use(task, *pair) for pair in zip(states[:-1], operators, strict=True)]
    for (one, use), (other, other_use) in itertools.combinations(zip(schedule.steps, uses, strict=True), 2):
        if one.start < other.end and other.start < one.end:
            assert one.step.agent != other.step.agent
            assert not use.deletes & (other_use.needs | other_use.adds | other_use.looks_at)
            assert not other_use.deletes & (use.needs | use.adds | use.looks_at)
            assert not (use.adds & other_use.looks_at) | (use.looks_at & other_use.adds)


def longest_chain(schedule):
    """The critical path by another way: the longest of all chains."""
    longest = []
    for scheduled in schedule.steps:
        longest.append(scheduled.duration + max((longest[other] for other in scheduled.after), default=0.0))
    return max(longest, default=0.0)


@given(st.integers(0, 10**6))
def test_the_makespan_is_the_length_of_the_critical_path(seed):
    _, actions, durations, schedule = random_schedule(seed, length=10)
    assert schedule.makespan == pytest.approx(longest_chain(schedule))
    on_path = [schedule.steps[number] for number in schedule.critical_path]
    assert sum(scheduled.duration for scheduled in on_path) == pytest.approx(schedule.makespan)
    for before, after in itertools.pairwise(on_path):
        assert after.start == before.end
    assert schedule.makespan <= sum(map(durations.of, actions)) + 1e-9
    for agent in schedule.agents:
        own = [scheduled for scheduled in schedule.steps if scheduled.step.agent == agent]
        assert schedule.makespan >= sum(scheduled.duration for scheduled in own) - 1e-9
    assert sorted(schedule.actions) == sorted(actions)


@given(st.integers(0, 10**6))
def test_a_schedule_made_from_its_own_order_starts_no_step_later(seed):
    task, _, durations, schedule = random_schedule(seed, length=10)
    # Where a disjunction was split, the new order may execute a step for another reason, which comes later.
    assume(all(len(task.operators_of(action)) == 1 for action in schedule.actions))
    again = make_schedule(Actors(task.problem), task, schedule.actions, durations)
    assert again.makespan <= schedule.makespan + 1e-9


def test_two_robots_on_a_map_walk_at_the_same_time():
    problem = encode(generate(np.random.default_rng(1), height=4, width=4, num_marks=2), "persistent")
    task = ground(problem.composite)
    robot = next(agent.name for agent in problem.agents if agent.kind == "robot")
    moves = [task.action(o) for o in task.applicable(task.initial_state) if task.action(o)[1] == robot]
    commands = [task.action(o) for o in task.applicable(task.initial_state) if task.action(o)[0] == "command"]
    schedule = make_schedule(problem, task, [moves[0], *commands])
    assert [scheduled.start for scheduled in schedule.steps] == [0.0, 0.0, 1.0]
    assert schedule.makespan == 2.0


def test_a_plan_that_the_task_refuses_is_an_error():
    problem = encode(generate(np.random.default_rng(1), height=4, width=4, num_marks=2))
    with pytest.raises(PlanError, match="step 1"):
        make_schedule(problem, ground(problem.composite), [("visit-room", "r1", "c-0-0")])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("default = 0", "above 0"),
        ("default = -1", "above 0"),
        ("default = nan", "finite"),
        ("default = inf", "finite"),
        ("default = true", "must be a number"),
        ("default = '1'", "must be a number"),
        ("speed = 1", "unknown key 'speed'"),
        ("schemas = 3", "must be a table"),
        ("[actions]\nmove = 1", "expected one step"),
        ("[", "no TOML"),
    ],
)
def test_bad_durations_are_refused_with_the_files_name(tmp_path, text, reason):
    path = tmp_path / "durations.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=f"durations.toml.*{reason}"):
        read_durations(path)


@pytest.mark.parametrize("duration", [0, -1.0, float("nan"), float("inf")])
def test_durations_are_above_nothing(duration):
    with pytest.raises(UsageError):
        Durations(schemas={"move": duration})

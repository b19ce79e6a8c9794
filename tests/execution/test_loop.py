import itertools

import numpy as np
import pytest
from hospital import hospital
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.execution.episodes import Ending
from explicable.execution.loop import Limits, run
from explicable.execution.monitor import TABLE, Event, State, react
from explicable.execution.participants import Participant
from explicable.execution.people import ScriptedPerson, SimulatedPerson
from explicable.execution.plans import Proposal, Situation
from explicable.execution.robots import SimulatedRobot, SimulatedWorld
from explicable.execution.setting import prepare
from explicable.first_response import builtin_maps, encode, generate
from explicable.model.grounding import ground_team
from explicable.search import Outcome

ASK_PLASTER, ASK_SYRINGE = ("ask", "nurse", "plaster"), ("ask", "nurse", "syringe")


class ShortestJointPlanner:
    """Plans the cheapest joint way from where the game is."""

    def __init__(self, setting):
        self.truth = setting.truth
        self.asked = []

    def __call__(self, situation):
        self.asked.append(situation.past)
        way = self.truth.mission_way(situation.state)
        if way is None:
            return Proposal(Outcome.UNSOLVABLE)
        return Proposal(Outcome.SOLVED, tuple(self.truth.task.action(operator) for operator in way))


class World(SimulatedWorld):
    """A world in which a person's steps are always possible: the loop has looked."""

    def see(self, course):
        """Take the steps of the person, as the course has taken them."""
        if course.occurrences[-1].event is Event.PERSON_COMMANDED and not course.occurrences[-1].refusal:
            self.take(course.occurrences[-1].notice.action)


def flaky(setting, pattern):
    """A robot that fails by a pattern, and what keeps its world up to date."""
    (name,) = [agent.name for agent in setting.problem.agents if agent.kind == "robot"]
    world, succeeds = World(ground_team(setting.problem).task), itertools.cycle(pattern)
    robot = SimulatedRobot(name, world, fault=lambda _: None if next(succeeds) else "slipped")
    return {"robots": [robot], "watch": world.see}


@pytest.fixture
def setting():
    return prepare(hospital())


def actions(played):
    return [step.action for step in played.episode.trace.steps]


def check_record(played):
    """The record follows the table from the start to an end."""
    state = State.DECIDING
    for occurrence in played.occurrences:
        if not occurrence.refusal:
            state, _ = react(state, occurrence.event)
        assert state is occurrence.state
    assert state not in {before for before, _ in TABLE}


def test_a_person_who_does_as_predicted_needs_one_plan(setting):
    planner = ShortestJointPlanner(setting)
    predicted = planner(Situation(setting.problem, (), (), setting.truth.task.initial_state)).actions
    script = [action for action in predicted if action[0] == "ask"]
    planner.asked.clear()
    played = run(setting, planner, ScriptedPerson(setting, script))
    assert played.episode.ending is Ending.REACHED
    assert played.num_deviations == 0
    assert planner.asked == [()]
    check_record(played)


def test_a_deviation_is_counted_and_answered_by_a_plan_from_there(setting):
    planner = ShortestJointPlanner(setting)
    played = run(setting, planner, ScriptedPerson(setting, [ASK_SYRINGE, ASK_PLASTER]))
    assert played.episode.ending is Ending.REACHED
    assert sorted(action for action in actions(played) if action[0] == "ask") == [ASK_PLASTER, ASK_SYRINGE]
    assert all(past == tuple(actions(played)[: len(past)]) for past in planner.asked)
    check_record(played)


@pytest.mark.parametrize(
    "planner",
    [
        lambda _: Proposal(Outcome.LIMIT),
        lambda _: Proposal(Outcome.SOLVED, (("go", "robo", "hall", "store"),)),
        lambda _: Proposal(Outcome.SOLVED),
    ],
    ids=["never ready", "impossible step", "leads nowhere"],
)
def test_without_a_usable_plan_the_robot_follows_the_requests(setting, planner):
    played = run(setting, planner, ScriptedPerson(setting, [ASK_PLASTER, ASK_SYRINGE]))
    assert played.episode.ending is Ending.REACHED
    check_record(played)


def test_a_planner_that_proves_there_is_no_plan_ends_the_game(setting):
    played = run(setting, lambda _: Proposal(Outcome.UNSOLVABLE), ScriptedPerson(setting, []))
    assert played.episode.ending is Ending.IMPOSSIBLE
    check_record(played)


def test_a_silent_person_and_a_robot_that_never_succeeds_end_in_stated_failures(setting):
    planner = ShortestJointPlanner(setting)
    silent = run(setting, planner, ScriptedPerson(setting, []))
    assert silent.episode.ending is Ending.STUCK
    broken = run(
        setting, planner, ScriptedPerson(setting, [ASK_PLASTER, ASK_SYRINGE]), **flaky(setting, [False])
    )
    assert broken.episode.ending in (Ending.STUCK, Ending.IMPOSSIBLE)
    assert not any(step.label is not None for step in broken.episode.trace.steps)


def test_a_run_stops_at_the_step_limit(setting):
    played = run(
        setting,
        ShortestJointPlanner(setting),
        ScriptedPerson(setting, [ASK_PLASTER]),
        limits=Limits(max_steps=1),
    )
    assert played.episode.ending is Ending.LIMIT


def play_disturbed(seed, robot, failing, readiness, semantics):
    rng = np.random.default_rng(seed)
    problem = encode(generate(rng, height=4, width=4, num_marks=2), semantics)
    setting = prepare(problem)
    plan, fails = ShortestJointPlanner(setting), itertools.cycle(failing)
    participant = Participant("simulated-1", learning=0.5, memory=0.8, readiness=readiness)
    played = run(
        setting,
        lambda situation: Proposal(Outcome.LIMIT) if next(fails) else plan(situation),
        SimulatedPerson(setting, participant, rng),
        **flaky(setting, robot),
    )
    check_record(played)
    failures = (Ending.STUCK, Ending.IMPOSSIBLE)
    assert played.episode.ending in ((Ending.REACHED,) if any(robot) else failures)
    task = ground_team(problem).task
    assert task.is_goal(task.execute(actions(played)).states[-1]) == any(robot)


disturbances = given(
    seed=st.integers(0, 1000),
    robot=st.lists(st.booleans(), min_size=1, max_size=3),
    failing=st.lists(st.booleans(), min_size=1, max_size=4),
    readiness=st.sampled_from([0.0, 0.5, 1.0]),
    semantics=st.sampled_from(["exclusive", "persistent"]),
)


@settings(max_examples=40, deadline=None)
@disturbances
def test_any_run_ends_and_every_step_is_legal(seed, robot, failing, readiness, semantics):
    play_disturbed(seed, robot, failing, readiness, semantics)


@pytest.mark.slow
@settings(max_examples=1000, deadline=None)
@disturbances
def test_many_disturbed_runs_end_by_legal_steps(seed, robot, failing, readiness, semantics):
    play_disturbed(seed, robot, failing, readiness, semantics)


def test_times_in_the_record_come_from_the_clock():
    setting = prepare(encode(builtin_maps("test")["test-01"], "exclusive"))
    ticks = itertools.count()
    person = SimulatedPerson(setting, Participant("simulated-1"), np.random.default_rng(0))
    played = run(setting, lambda _: Proposal(Outcome.LIMIT), person, clock=lambda: float(next(ticks)))
    assert played.episode.ending is Ending.REACHED
    times = [occurrence.time_s for occurrence in played.occurrences]
    assert times == sorted(times)
    assert set(played.planning_s) == {1.0}
    assert played.occurrences[-1].event is Event.GOAL_HOLDS

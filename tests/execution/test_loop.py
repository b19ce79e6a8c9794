import concurrent.futures
import itertools
import threading

import numpy as np
import pytest
from hospital import hospital
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.execution.episode_files import read_episode, write_episode
from explicable.execution.episodes import Ending
from explicable.execution.facts import correct_model, observable_facts
from explicable.execution.loop import ClosedLoop, run
from explicable.execution.monitor import TABLE, Event, State, react
from explicable.execution.notices import Notice
from explicable.execution.participants import Participant
from explicable.execution.people import ScriptedPerson, SimulatedPerson
from explicable.execution.plans import Proposal, Situation
from explicable.execution.records import record, replay
from explicable.execution.robots import Fact, SimulatedRobot, SimulatedWorld
from explicable.execution.robots.faultless import FaultlessRobot
from explicable.execution.runs import Limits
from explicable.execution.setting import prepare
from explicable.first_response import World as Map
from explicable.first_response import builtin_maps, encode, generate
from explicable.model.grounding import ground_team
from explicable.search import Outcome, search

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


@settings(max_examples=40)
@disturbances
def test_any_run_ends_and_every_step_is_legal(seed, robot, failing, readiness, semantics):
    play_disturbed(seed, robot, failing, readiness, semantics)


@pytest.mark.slow
@settings(max_examples=1000)
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


class Waiting:
    """A planner that answers only when it is let, as a slow one would."""

    def __init__(self, planner):
        self.planner, self.released = planner, threading.Event()

    def __call__(self, situation):
        assert self.released.wait(600)
        return self.planner(situation)


def test_a_late_planner_does_not_stop_the_robot_and_its_plan_is_taken_when_ready():
    setting = prepare(encode(builtin_maps("test")["test-01"], "exclusive"))
    planner = Waiting(ShortestJointPlanner(setting))

    def watch(course):
        if len(course.steps) >= 5 and not planner.released.is_set():
            planner.released.set()
            concurrent.futures.wait([loop._desk._plan])  # else the game may be over before the plan is there

    person = SimulatedPerson(setting, Participant("simulated-1"), np.random.default_rng(0))
    loop = ClosedLoop(setting, planner, person, limits=Limits(plan_s=0.01), background=True, watch=watch)
    played = loop.run()
    assert played.episode.ending is Ending.REACHED
    states = [occurrence.state for occurrence in played.occurrences]
    events = [occurrence.event for occurrence in played.occurrences]
    assert State.BRIDGING in states
    ready = events.index(Event.PLAN_READY)
    assert events[:ready].count(Event.STEP_FINISHED) >= 4
    truth, asked = setting.truth, actions(played)[0]
    after = truth.task.successor(truth.task.initial_state, truth.operator(truth.task.initial_state, asked))
    safe = truth.fulfilment_way(after, truth.requests[asked])
    assert actions(played)[1:5] == [truth.task.action(operator) for operator in safe[:4]]
    check_record(played)


def test_a_planner_that_never_answers_ends_in_a_stated_failure_or_without_it(setting):
    planner = Waiting(ShortestJointPlanner(setting))
    limits = Limits(plan_s=0.001, patience=10)
    person = ScriptedPerson(setting, [ASK_PLASTER, ASK_SYRINGE])
    played = run(setting, planner, person, limits=limits, background=True)
    planner.released.set()
    assert played.episode.ending is Ending.REACHED  # by the safe thing alone
    silent = Waiting(ShortestJointPlanner(setting))
    played = run(setting, silent, ScriptedPerson(setting, []), limits=limits, background=True)
    silent.released.set()
    assert played.episode.ending is Ending.STUCK


class Slow(FaultlessRobot):
    """A robot that needs a few looks at it before a step is done."""

    def __init__(self, name, during=lambda: None):
        super().__init__(name)
        self.during, self.num_polls, self.num_cancelled = during, 0, 0

    def poll(self, timeout_s=0.0):
        self.num_polls += 1
        self.during()
        return super().poll(timeout_s) if self.num_polls % 4 == 0 else None

    def cancel(self):
        self.num_cancelled += 1


def test_what_comes_from_outside_while_the_robot_acts_counts_after_its_step(setting):
    notices = [
        Notice(Event.PERSON_COMMANDED, ASK_SYRINGE),
        Notice(Event.STEP_FAILED, ("sing",)),
        Notice(Event.PLAN_READY),
    ]

    def during():
        if notices:
            loop.notify(notices.pop())

    robot = Slow("robo", during)
    loop = ClosedLoop(setting, ShortestJointPlanner(setting), ScriptedPerson(setting, [ASK_PLASTER]), [robot])
    played = loop.run()
    assert played.episode.ending is Ending.REACHED
    events = [(occurrence.event, bool(occurrence.refusal)) for occurrence in played.occurrences]
    assert (Event.PLAN_READY, True) in events
    commanded = [
        (occurrence.state, len(occurrence.refusal))
        for occurrence in played.occurrences
        if occurrence.notice == Notice(Event.PERSON_COMMANDED, ASK_SYRINGE)
    ]
    assert commanded[0] == (State.ACTING, 0)  # kept
    assert commanded[1] == (State.DECIDING, 0)  # taken
    check_record(played)


def test_a_robot_that_says_nothing_is_asked_to_stop_and_then_taken_for_lost(setting):
    class Silent(Slow):
        def poll(self, timeout_s=0.0):  # noqa: ARG002 (it has nothing to say)
            return None

    ticks, robot = itertools.count(), Silent("robo")
    played = run(
        setting,
        ShortestJointPlanner(setting),
        ScriptedPerson(setting, [ASK_PLASTER, ASK_SYRINGE]),
        [robot],
        limits=Limits(step_s=5.0),
        clock=lambda: float(next(ticks)),
    )
    assert played.episode.ending is Ending.STUCK
    assert robot.num_cancelled == 1
    reasons = [occurrence.notice.reason for occurrence in played.occurrences]
    assert reasons.count("the robot is lost") == 1
    assert "order 1 is still open" not in reasons  # it is sent nothing more


def test_two_people_and_two_robots_play_and_each_person_takes_their_own_steps(tmp_path):
    problem = encode(Map(("@.*.@", ".....", "*...*")), num_people=2)
    setting = prepare(problem, observable_facts(problem))
    rooms = [("command", "person", "c-0-2"), ("command", "person-2", "c-2-0"), ("command", "person", "c-2-4")]
    first = ScriptedPerson(setting, [rooms[0], rooms[1], rooms[2]], answer=lambda _: True)
    second = ScriptedPerson(setting, [rooms[1]], answer=lambda action: action[0] != "move")
    second.name = "another"
    played = run(setting, ShortestJointPlanner(setting), (first, second))
    assert played.episode.ending is Ending.REACHED
    human = [step.action for step in played.episode.trace.steps if step.action[0] == "command"]
    assert set(human) == set(rooms)
    labels = {step.action[0]: step.label for step in played.episode.trace.steps}
    assert labels == {"command": None, "move": False, "visit-room": True}  # both have to be content
    write_episode(
        tmp_path / "game.jsonl", record(played, setting.truth.task, observable=observable_facts(problem))
    )
    assert replay(read_episode(tmp_path / "game.jsonl")).differences == ()
    with pytest.raises(UsageError, match="person-2"):
        run(setting, ShortestJointPlanner(setting), (first, second, first))


def test_the_rest_is_planned_anew_without_a_robot_that_is_lost():
    problem = encode(Map(("@.*", "..@")))
    setting = prepare(problem)
    ticks = itertools.count()

    class Silent(FaultlessRobot):
        def poll(self, timeout_s=0.0):  # noqa: ARG002 (it has nothing to say)
            return None

    def plan(situation):
        task = ground_team(situation.problem).task
        state = task.execute(situation.past).states[-1]
        result = search(task, "astar", initial_state=state)
        return Proposal(result.outcome, tuple(map(task.action, result.operators or ())))

    person = ScriptedPerson(setting, [("command", "person", "c-0-2")])
    for silent, ending in ((["r2"], Ending.REACHED), (["r1", "r2"], Ending.IMPOSSIBLE)):
        robots = [Silent(name) if name in silent else FaultlessRobot(name) for name in ("r1", "r2")]
        person = ScriptedPerson(setting, [("command", "person", "c-0-2")])
        clock = lambda: float(next(ticks))  # noqa: E731 (short)
        played = run(setting, plan, person, robots, limits=Limits(step_s=5.0), clock=clock)
        assert played.episode.ending is ending
        lost = [it.notice.agent for it in played.occurrences if it.event is Event.AGENT_LOST]
        assert sorted(lost) == silent
        check_record(played)


def test_an_aborted_game_says_so(setting):
    def interrupt(_):
        raise KeyboardInterrupt

    loop = ClosedLoop(setting, interrupt, ScriptedPerson(setting, []))
    with pytest.raises(KeyboardInterrupt):
        loop.run()
    assert loop.result().episode.ending is Ending.ABORTED


def test_each_robot_of_the_team_must_be_there(setting):
    with pytest.raises(UsageError, match="robo"):
        run(setting, ShortestJointPlanner(setting), ScriptedPerson(setting, []), [FaultlessRobot("nobody")])


@pytest.mark.parametrize("blocked", ["c-0-1", "c-0-2"])
def test_a_way_that_is_blocked_is_found_out_and_gone_around(blocked):
    problem = encode(Map(("@..*", "....")), "exclusive")
    setting = prepare(problem, observable_facts(problem))
    world = World(setting.truth.task)
    world.state = setting.truth.stage.believe(world.state, ("clear", blocked), true=False)
    person = ScriptedPerson(setting, [("command", "person", "c-0-3")])
    robot = SimulatedRobot("r1", world)
    played = run(setting, ShortestJointPlanner(setting), person, [robot], watch=world.see)
    assert played.episode.ending is Ending.REACHED
    moves = [occurrence for occurrence in played.occurrences if occurrence.event is Event.ROBOT_NEXT]
    assert sum(occurrence.notice.action[-1] == blocked for occurrence in moves) == 1
    really = correct_model(problem, [Fact(("clear", blocked), true=False)])
    assert ground_team(really).task.execute(actions(played))
    check_record(played)

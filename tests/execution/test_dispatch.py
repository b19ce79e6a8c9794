import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.errors import UsageError
from explicable.execution import prepare, read_episode, record, replay, write_episode
from explicable.execution.dispatch import Dispatcher
from explicable.execution.dispatch_run import DispatchLimits
from explicable.execution.episodes import Ending
from explicable.execution.facts import change_state, observable_facts
from explicable.execution.robots import (
    Accepted,
    Fact,
    Failed,
    Finished,
    Observation,
    Refused,
    SimulatedRobot,
    SimulatedWorld,
)
from explicable.first_response import World, encode, generate
from explicable.model.durations import Durations
from explicable.model.grounding import ground
from explicable.model.schedule import make_schedule
from explicable.search import search

CORRIDORS = World(("@..*", "####", "*..@"))


def on_record(run, stage):
    return record(run.played, stage.setting.truth.task, observable=observable_facts(stage.problem))


class Time:
    """Passes when told to."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now

    def pause(self, _):
        self.now += 0.25


def plan(problem, durations=None):
    task = ground(problem.composite)
    result = search(task)
    if result.operators is None:
        return None
    return make_schedule(problem, task, tuple(map(task.action, result.operators)), durations)


class Stage:
    """A team on a map, in a world that may be other than the team knows."""

    def __init__(self, problem, *, news=(), durations=None, fault=lambda _: None, takes=None, **limits):
        self.problem, self.time = problem, Time()
        durations = durations or Durations()
        takes = takes or durations.of
        self.setting = setting = prepare(problem, observable_facts(problem))
        self.world = SimulatedWorld(setting.truth.task)
        self.world.state = change_state(setting.truth.stage, self.world.state, news)
        self.crew = [
            SimulatedRobot(agent.name, self.world, duration=takes, clock=self.time, fault=fault)
            for agent in problem.agents
        ]
        self.schedule = plan(problem, durations)
        self.plans = []
        self.dispatcher = Dispatcher(
            setting,
            self.schedule,
            self.crew,
            replan=self.replan,
            limits=DispatchLimits(**{"step_s": 20.0, "total_s": 2000.0, **limits}),
            clock=self.time,
            pause=self.time.pause,
        )

    def replan(self, problem):
        self.plans.append(problem)
        return plan(problem)

    def run(self):
        run = self.dispatcher.run()
        if run.ending is Ending.REACHED:
            assert self.world.task.is_goal(self.world.state)
        return run


def test_two_robots_and_two_people_act_at_once():
    durations = Durations(schemas={"move": 2.0, "visit-room": 4.0, "command": 0.5})
    stage = Stage(encode(CORRIDORS, num_people=2), durations=durations)
    run = stage.run()
    assert run.ending is Ending.REACHED
    assert run.num_plans == 0
    assert {done.step.agent for done in run.steps} >= {"r1", "r2"}
    slack = 0.25 * 2 * len(run.steps)  # each answer is heard at the next tick
    assert stage.schedule.makespan <= run.makespan_s <= stage.schedule.makespan + slack
    assert run.makespan_s < 0.7 * sum(scheduled.duration for scheduled in stage.schedule.steps)


def test_a_late_step_delays_its_successors_only():
    problem = encode(CORRIDORS)
    prompt = Stage(problem).run()
    slow = ("move", "r1", "c-0-0", "c-0-1")
    late = Stage(problem, takes=lambda action: 10.0 if action == slow else 1.0).run()
    ends = [{done.step.action: done.end_s for done in run.steps} for run in (prompt, late)]
    assert late.num_plans == 0
    for action in ends[0]:
        if action[1] == "r2":
            assert ends[0][action] == ends[1][action]
    assert ends[1]["visit-room", "r1", "c-0-3"] == ends[0]["visit-room", "r1", "c-0-3"] + 9.0


def test_a_failed_step_is_tried_again():
    failures = iter(["wheel stuck", "wheel stuck"])
    run = Stage(
        encode(CORRIDORS), fault=lambda action: next(failures, None) if action[1] == "r1" else None
    ).run()
    assert (run.ending, run.num_plans) == (Ending.REACHED, 0)
    assert sum(not isinstance(done.report, Finished) for done in run.steps) == 2


BLOCKED = Fact(("clear", "c-0-1"), true=False)


def test_a_blocked_way_is_found_out_and_gone_round():
    problem = encode(World(("@.*", "...", "@.*")))
    stage = Stage(problem, news=[BLOCKED])
    run = stage.run()
    assert run.ending is Ending.REACHED
    assert run.num_plans == 1
    assert all(BLOCKED.atom not in replanned.robot.init for replanned in stage.plans)


def test_without_another_way_it_ends_in_a_stated_failure():
    problem = encode(World(("@.*",)))
    stage = Stage(problem, news=[BLOCKED])
    assert stage.run().ending is Ending.IMPOSSIBLE


def test_a_step_that_never_succeeds_is_put_down_to_a_fact():
    run = Stage(encode(World(("@.*",))), fault=lambda action: "no" if action[0] == "move" else None).run()
    assert run.ending is Ending.IMPOSSIBLE
    assert 1 <= run.num_plans <= 4


def test_a_robot_that_falls_silent_is_lost_and_the_others_finish_what_they_can():
    run = Stage(encode(CORRIDORS), step_s=5.0).run()
    silent = Stage(encode(CORRIDORS), step_s=5.0)
    robot = next(member for member in silent.crew if member.name == "r1")
    robot.poll = lambda _=0.0: None
    lost = silent.run()
    assert lost.ending is Ending.IMPOSSIBLE  # no other robot can get there
    assert (lost.lost, lost.num_plans) == ({"r1"}, 1)
    done = {done.step.action for done in lost.steps if isinstance(done.report, Finished)}
    assert {step.step.action for step in run.steps if step.step.agent == "r2"} <= done


@pytest.mark.parametrize("when", [0, 1, 2])
@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
def test_the_others_take_over_from_a_robot_that_is_lost(semantics, when):
    problem = encode(World(("@.*", "...", "*.@")), semantics, num_people=2)
    stage = Stage(problem, step_s=3.0)
    robot = next(member for member in stage.crew if member.name == stage.schedule.steps[-1].step.agent)
    robot.poll = lambda _=0.0, poll=robot.poll: poll() if stage.time() < when else None
    robot.send = lambda order, send=robot.send: send(order) if stage.time() < when else Accepted(order.number)
    run = stage.run()
    assert (run.ending, run.lost) == (Ending.REACHED, {robot.name})
    assert {agent.name for agent in problem.agents if agent.kind == "robot"} > run.lost
    assert replay(on_record(run, stage)).differences == ()


def test_a_person_who_is_lost_is_done_without():
    stage = Stage(encode(CORRIDORS, num_people=2), step_s=3.0)
    person = next(member for member in stage.crew if member.name == "person")
    person.send = lambda order: Refused(order.number, "no tablet")
    run = stage.run()
    assert (run.ending, run.lost) == (Ending.REACHED, {"person"})
    assert {done.step.agent for done in run.steps} == {"person-2", "r1", "r2"}


def test_a_run_on_record_is_replayed_exactly(tmp_path):
    stage = Stage(encode(World(("@.*", "...", "@.*")), num_people=2), news=[BLOCKED])
    run = stage.run()
    recorded = on_record(run, stage)
    write_episode(tmp_path / "run.jsonl", recorded)
    again = read_episode(tmp_path / "run.jsonl")
    assert again == recorded
    assert again.at_once
    replayed = replay(again)
    assert replayed.differences == ()
    assert replayed.course.has_reached_goal
    finished = [done.step.action for done in run.steps if isinstance(done.report, Finished)]
    assert [step.action for step in again.trace.steps] == finished
    false = replace(again, events=(*again.events[:8], *again.events[9:]))
    assert replay(false).differences


def test_a_robot_that_is_out_of_reach_for_a_while_is_waited_for():
    stage = Stage(encode(CORRIDORS))
    robot = next(member for member in stage.crew if member.name == "r1")
    send = robot.send
    robot.send = lambda order: send(order) if stage.time() > 7 else Refused(order.number, "not connected")
    run = stage.run()
    assert (run.ending, run.num_plans, run.lost) == (Ending.REACHED, 0, frozenset())


def test_a_person_who_acts_of_their_own_accord_is_heeded():
    stage = Stage(encode(CORRIDORS, "exclusive"))
    for action in [
        ("command", "person", "c-2-0"),
        ("command", "person", "c-9-9"),
        ("move", "r1", "c-0-0", "c-0-1"),
        ("command", "person", "c-0-3"),
    ]:
        stage.world.take(action) if action[0] == "command" else None
        stage.dispatcher.notify(action)
    run = stage.run()
    assert run.ending is Ending.REACHED
    own = [done.step.action for done in run.steps if done.report is None]
    assert own == [("command", "person", "c-2-0"), ("command", "person", "c-0-3")]


def test_an_agent_given_up_for_lost_that_answers_after_all_is_back():
    stage = Stage(encode(CORRIDORS), step_s=4.0)
    robot = next(member for member in stage.crew if member.name == "r1")
    poll = robot.poll
    robot.poll = lambda _=0.0: poll() if not 1 <= stage.time() <= 9 else None
    robot.cancel = lambda: None
    slow = next(member for member in stage.crew if member.name == "r2")
    slow._duration = lambda _: 3.0
    run = stage.run()
    assert any(done.report is None and done.step.agent == "r1" for done in run.steps)
    assert (run.ending, run.lost) == (Ending.REACHED, frozenset())


def test_a_robot_that_never_stops_talking_or_contradicts_itself_ends_nothing_and_hides_nothing():
    for facts in ([True], [True, False]):
        stage = Stage(encode(World(("@.*", "...", "@.*"))), max_plans=5)
        robot = next(member for member in stage.crew if member.name == "r1")
        poll, says = robot.poll, itertools.cycle(facts)
        robot.poll = lambda _=0.0, poll=poll, says=says, stage=stage: (
            stage.time.pause(0) or poll() or Observation((Fact(("clear", "c-1-1"), true=next(says)),))
        )
        run = stage.run()
        assert run.ending in ((Ending.REACHED,) if facts == [True] else (Ending.REACHED, Ending.STUCK))
        assert run.num_plans <= 5


def test_the_whole_takes_no_longer_than_it_may():
    stage = Stage(encode(CORRIDORS), takes=lambda _: 50.0, step_s=1000.0, total_s=30.0)
    run = stage.run()
    assert run.ending is Ending.TIME
    assert all(isinstance(member.poll(), Failed) for member in stage.crew if member.state().order)


def test_breaking_off_asks_everybody_to_stop():
    stage = Stage(encode(CORRIDORS))

    def break_off(_):
        raise KeyboardInterrupt

    stage.dispatcher._pause = break_off
    with pytest.raises(KeyboardInterrupt):
        stage.run()
    busy = [member for member in stage.crew if member.state().order]
    assert busy
    assert all(isinstance(member.poll(), Failed) for member in busy)


def test_each_agent_needs_one_robot():
    problem = encode(CORRIDORS)
    setting, schedule = prepare(problem), plan(problem)
    world = SimulatedWorld(setting.truth.task)
    robots = [SimulatedRobot(agent.name, world) for agent in problem.agents]
    for crew in (robots[1:], [*robots, robots[0]]):
        with pytest.raises(UsageError, match="one robot"):
            Dispatcher(setting, schedule, crew)


@settings(max_examples=25)
@given(
    seed=st.integers(0, 10**6),
    semantics=st.sampled_from(["persistent", "exclusive"]),
    fails=st.floats(0, 0.5),
    hides=st.booleans(),
)
def test_every_run_ends_and_no_illegal_step_is_sent(seed, semantics, fails, hides):
    rng = np.random.default_rng(seed)
    problem = encode(generate(rng, height=4, width=4, num_marks=2, num_robots=2), semantics, num_people=2)
    clear = [atom for atom in problem.robot.init if atom[0] == "clear"]
    hidden = Fact(clear[rng.integers(len(clear))], true=False)
    stage = Stage(
        problem,
        news=[hidden] if hides else [],
        fault=lambda _: "chance" if rng.random() < fails else None,
        takes=lambda _: float(rng.choice([0.5, 1.0, 3.0])),
    )
    run = stage.run()
    assert run.ending in (Ending.REACHED, Ending.IMPOSSIBLE, Ending.STUCK)
    if not hides and fails == 0:
        assert (run.ending, run.num_plans) == (Ending.REACHED, 0)
    # What was reported as done is possible in the world as it really is, and no more has been done there.
    task = stage.world.task
    start = change_state(stage.setting.truth.stage, task.initial_state, [hidden] if hides else [])
    finished = [done.step.action for done in run.steps if isinstance(done.report, Finished)]
    assert task.execute(finished, start).states[-1] == stage.world.state
    assert replay(on_record(run, stage)).differences == ()

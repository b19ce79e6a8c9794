"""Games in which all goes wrong that can: the world, the robot, the person, the planner, the messages."""

import numpy as np

from explicable.evaluation.strategies import ClassicalPlanner, NearestPlanner, follow
from explicable.execution import (
    ClosedLoop,
    Limits,
    Notice,
    Participant,
    Proposal,
    SimulatedPerson,
    observable_facts,
    prepare,
)
from explicable.execution.monitor import Event
from explicable.execution.robots import (
    Accepted,
    Blocked,
    Fact,
    Failed,
    Finished,
    Observation,
    Refused,
    RobotState,
)
from explicable.first_response import encode, generate
from explicable.search import Outcome

FATAL = (Event.NO_PLAN_EXISTS, Event.TIME_UP, Event.ABORT)
"""Notices that rightly end a game, from whomever they come."""


class World:
    """The truth, in which ways get blocked."""

    def __init__(self, setting, rng, blocking):
        self.truth, self.rng, self.blocking = setting.truth, rng, blocking
        self.state = setting.truth.task.initial_state
        self.atoms = [
            atom for atom in sorted(setting.truth.stage.beliefs) if atom[0] in ("clear", "adjacent")
        ]

    def happen(self):
        """Block a way, for ever."""
        if self.atoms and self.rng.random() < self.blocking:
            atom = self.atoms[int(self.rng.integers(len(self.atoms)))]
            self.state = self.truth.stage.believe(self.state, atom, true=False)

    def take(self, action):
        """Take a step; return what is in its way if it can't be taken."""
        operator = self.truth.operator(self.state, action)
        if operator is not None:
            self.state = self.truth.task.successor(self.state, operator)
            return ()
        task = self.truth.task
        lacking = []
        for fact in task.core.preconditions(task.operators_of(action)[0]):
            atom = task.fact(fact)
            if not task.core.holds(self.state, [fact]):
                lacking.append(Fact(atom[1:]) if atom[0] == "not" else Fact(atom, true=False))
        return tuple(lacking)

    def see(self, course):
        """Follow the person's steps."""
        last = course.occurrences[-1]
        if last.event is Event.PERSON_COMMANDED and course.steps and course.steps[-1].time == last.time_s:
            self.take(last.notice.action)


class Robot:
    """Loses, repeats and invents reports; refuses orders; says what can't be."""

    def __init__(self, name, world, rng, trouble):
        self.name, self.world, self.rng, self.trouble = name, world, rng, trouble
        self.order, self.reports, self.orders = None, [], []

    def goes_wrong(self):
        return self.rng.random() < self.trouble

    def send(self, order):
        if self.goes_wrong():
            return Refused(order.number, "no connection")
        self.orders.append(order.action)
        self.world.happen()
        if self.goes_wrong():
            self.reports.append(self.invented(order))
        if self.goes_wrong():
            self.reports.append(Failed(order.number, "slipped"))
        else:
            lacking = self.world.take(order.action)
            report = Blocked(order.number, lacking) if lacking else Finished(order.number)
            if not self.goes_wrong():  # else it is lost
                self.reports.append(report)
            if self.goes_wrong():
                self.reports.append(report)
        return Accepted(order.number)

    def invented(self, order):
        cell, other = (f"c-{a}-{b}" for a, b in self.rng.integers(1, 5, size=(2, 2)))
        return [
            Finished(order.number + 7),
            Finished(order.number - 1),
            Observation((Fact(("at", self.name, cell)), Fact(("at", self.name, other)))),
            Observation((Fact(("at", self.name, cell)),)),
            Observation((Fact(("at", self.name, "moon")),)),
            Observation((Fact(("clear", cell), true=False),)),
            Observation((Fact(("clear", cell)),)),
            Observation((Fact(("visited", cell)), Fact(("unvisited", cell)))),
            Observation((Fact(("at", self.name, cell), true=False),)),
            Blocked(order.number, ()),
            Blocked(order.number, (Fact(("clear", cell)),)),
        ][int(self.rng.integers(11))]

    def poll(self, timeout_s=0.0):  # noqa: ARG002 (it never waits)
        return self.reports.pop(0) if self.reports else None

    def cancel(self):
        if not self.goes_wrong() and self.orders:
            self.reports.append(Failed(len(self.orders), "cancelled"))

    def state(self):
        return RobotState(connected=True)

    def close(self):
        pass


class Person(SimulatedPerson):
    """Contradicts itself, and asks for what can't be."""

    def __init__(self, setting, rng, trouble):
        participant = Participant("simulated-1", learning=0.5, memory=0.8, readiness=0.5)
        super().__init__(setting, participant, rng)
        self.trouble = trouble
        self.strange = [
            ("command", "person", "c-0-0"),
            ("command", "nobody", "c-1-1"),
            ("sing",),
            ("move", "r1"),
        ]
        self.strange += sorted(setting.truth.requests)

    def thinks_over(self):
        return self.rng.random() < self.trouble or super().thinks_over()

    def choose(self, refused):
        if self.rng.random() < self.trouble:
            return self.strange[int(self.rng.integers(len(self.strange)))]
        return None if self.rng.random() < self.trouble else super().choose(refused)


def troubled(planner, rng, trouble):
    """A planner that is out of time, or babbles."""

    def plan(situation):
        if rng.random() >= trouble:
            return planner(situation)
        babble = (("move", "r1", "c-1-1", "c-1-2"), ("visit-room", "r1", "c-1-1"))
        return [Proposal(Outcome.LIMIT), Proposal(Outcome.SOLVED, babble), Proposal(Outcome.SOLVED)][
            int(rng.integers(3))
        ]

    return plan


def make_setting(seed, semantics):
    """A small map, prepared for all that can be observed."""
    problem = encode(generate(np.random.default_rng(seed), height=4, width=4, num_marks=2), semantics)
    return prepare(problem, observable_facts(problem))


def disturbed_loop(setting, seed):
    """A game that goes wrong in its own measure."""
    rng = np.random.default_rng(seed)
    trouble = float(rng.choice([0.0, 0.05, 0.2]))
    world = World(setting, rng, blocking=float(rng.choice([0.0, 0.02, 0.2])))
    robot, person = Robot("r1", world, rng, trouble), Person(setting, rng, trouble)
    planner = [follow, NearestPlanner(setting), ClassicalPlanner()][int(rng.integers(3))]
    ticks = iter(range(10**9))
    actions = [*person.strange, ("move", "r1", "c-1-1", "c-1-2"), ()]

    def watch(course):
        world.see(course)
        if rng.random() < trouble / 2:  # somebody else sends what comes into their head
            events = [event for event in Event if event not in FATAL]
            event = events[int(rng.integers(len(events)))]
            action = actions[int(rng.integers(len(actions)))]
            facts = (Fact(("clear", "c-1-1"), true=bool(rng.integers(2))),)
            loop.notify(Notice(event, action, facts, bool(rng.integers(2)), (action,) if action else ()))

    loop = ClosedLoop(
        setting,
        troubled(planner, rng, trouble),
        person,
        [robot],
        limits=Limits(max_steps=200, step_s=5.0, plan_s=1.0),
        clock=lambda: 0.1 * next(ticks),
        watch=watch,
    )
    return loop, robot, world

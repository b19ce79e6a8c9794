import math
from collections import deque
from contextlib import contextmanager

import pytest
from rigs import BLOCKS, FAILS, FINISHES, HANGS, STEPS, corridor, scripted_report

from explicable.execution.robots import (
    Accepted,
    Blocked,
    Door,
    Fact,
    Failed,
    Finished,
    Observation,
    Order,
    OrderBook,
    Refused,
    RobotState,
    SimulatedRobot,
    SimulatedWorld,
)
from explicable.execution.robots.conformance import Rig, check


def simulated():
    return SimulatedRobot(
        "r1",
        SimulatedWorld(corridor()),
        duration=lambda action: math.inf if action == HANGS else 0.0,
        fault=lambda action: "wheel stuck" if action == FAILS else None,
    )


class Scripted:
    """A robot that says at once what the test has put down."""

    name = "r1"

    def __init__(self, *reports):
        self.book = OrderBook()
        self.reports = deque(reports)
        self.closed = self.cancelled = False

    def send(self, order):
        if self.closed:
            return Refused(order.number, "closed")
        answer = self.book.open(order)
        if isinstance(answer, Accepted) and (report := scripted_report(order)):
            self.reports.append(report)
        return answer

    def poll(self, timeout_s=0.0):  # noqa: ARG002 (it never waits)
        if not self.reports or self.closed:
            return None
        if not isinstance(self.reports[0], Observation):
            self.book.answer(self.reports[0].number)
        return self.reports.popleft()

    def cancel(self):
        if self.book.order and not self.cancelled:
            self.reports.append(Failed(self.book.order.number, "cancelled"))
            self.cancelled = True

    def state(self):
        return RobotState(not self.closed, self.book.order)

    def close(self):
        self.closed = True


@pytest.mark.parametrize("make", [simulated, Scripted, lambda: Door(simulated(), corridor())])
def test_robots_made_of_software_conform(make):
    @contextmanager
    def rig():
        yield Rig(make(), **STEPS)

    assert check(rig) == ()


class TakesTwo(Scripted):
    def send(self, order):
        return Accepted(order.number)


class CancelsByFinishing(Scripted):
    def cancel(self):
        if self.book.order:
            self.reports.append(Finished(self.book.order.number))


class AnswersTwice(Scripted):
    def poll(self, timeout_s=0.0):
        report = super().poll(timeout_s)
        if isinstance(report, Finished) and not self.cancelled:
            self.cancelled = True
            self.reports.append(report)
        return report


class TalksWhenClosed(Scripted):
    def close(self):
        pass


@pytest.mark.parametrize(
    ("broken", "found"),
    [
        (TakesTwo, "is_busy"),
        (CancelsByFinishing, "cancels"),
        (AnswersTwice, "finishes_in_order"),
        (TalksWhenClosed, "closes"),
    ],
)
def test_the_checks_find_broken_adapters(broken, found):
    @contextmanager
    def rig():
        yield Rig(broken(), **STEPS)

    assert found in {line.split(":")[0] for line in check(rig)}


def test_a_simulated_robot_changes_the_world_and_says_what_is_in_its_way():
    world = SimulatedWorld(corridor())
    robot = SimulatedRobot("r1", world)
    robot.send(Order(1, FINISHES[1]))
    assert robot.poll() == Blocked(1, (Fact(("at", "r1", "c-0-1"), true=False),))
    robot.send(Order(2, FINISHES[0]))
    assert robot.poll() == Finished(2)
    assert world.task.holds(("at", "r1", "c-0-1"), world.state)


def test_a_simulated_robot_takes_its_time_by_the_clock():
    now = [0.0]
    robot = SimulatedRobot("r1", SimulatedWorld(corridor()), duration=lambda _: 2.0, clock=lambda: now[0])
    robot.send(Order(1, FINISHES[0]))
    now[0] = 1.9
    assert robot.poll(60) is None
    now[0] = 2.0
    assert robot.poll() == Finished(1)


@pytest.mark.parametrize(
    ("facts", "reason"),
    [
        ([(("at", "r1", "c-0-1"), True), (("at", "r1", "c-0-2"), True)], "exclude each other"),
        ([(("clear", "c-0-1"), True), (("clear", "c-0-1"), False)], "both true and false"),
        ([(("on-fire", "c-0-1"), True)], "no known predicate"),
        ([(("clear", "c-9-9"), True)], "unknown object"),
        ([(("clear",), True)], "0 arguments"),
        ([(("clear", "r1"), True)], "has r1 where cell belongs"),
        ([((), True)], "no known predicate"),
    ],
)
def test_facts_that_cannot_be_are_turned_away_but_the_order_counts_as_answered(facts, reason):
    facts = tuple(Fact(atom, true) for atom, true in facts)
    door = Door(Scripted(Observation(facts), Finished(1, facts), Blocked(2, facts)), corridor())
    assert door.poll() is None
    door.send(Order(1, HANGS))
    assert door.poll() == Finished(1)
    door.send(Order(2, HANGS))
    answer = door.poll()
    assert isinstance(answer, Failed)
    assert reason in answer.reason
    assert [reason in objection.reason for objection in door.objections] == [True] * 3
    assert door.state().order is None


def test_duplicates_and_answers_to_orders_that_nobody_gave_are_dropped():
    ghost, news = Finished(7), Observation((Fact(("clear", "c-0-4"), true=False),))
    door = Door(Scripted(ghost), corridor())
    assert door.poll() is None
    door.send(Order(1, FINISHES[0]))
    door._robot.reports.extend([Finished(1), Failed(1, "no, after all"), news])
    answers = [door.poll() for _ in range(4)]
    assert answers == [Finished(1, (Fact(("at", "r1", "c-0-1")),)), None, None, news]
    assert [objection.report for objection in door.objections] == [
        ghost,
        Finished(1),
        Failed(1, "no, after all"),
    ]


def test_no_step_that_the_task_does_not_know_reaches_the_robot():
    robot = Scripted()
    door = Door(robot, corridor())
    for action in [("fly", "r1"), ("move", "r1", "c-0-0", "c-1-0"), ("move", "r2", "c-0-0", "c-0-1"), ()]:
        assert isinstance(door.send(Order(1, action)), Refused)
    assert robot.book.last_number == 0
    assert door.send(Order(1, BLOCKS)) == Accepted(1)

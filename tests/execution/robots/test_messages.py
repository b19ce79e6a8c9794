import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rigs import FINISHES, HANGS

from explicable.errors import RobotError
from explicable.execution.robots import Accepted, Blocked, Fact, Failed, Finished, Observation, Order
from explicable.execution.robots.messages import (
    MAX_BYTES,
    CancelMessage,
    HelloMessage,
    ReportMessage,
    StepMessage,
    decode_message,
    encode_message,
)
from explicable.execution.robots.remote import Receipt, RemoteRobot, RobotSide

names = st.text("ab-1", min_size=1, max_size=5)
numbers = st.integers(1, 2**53 - 1)
atoms = st.lists(names, min_size=1, max_size=4).map(tuple)
facts = st.lists(st.builds(Fact, atoms, st.booleans()), max_size=3).map(tuple)
reports = st.one_of(
    st.builds(Finished, numbers, facts),
    st.builds(Failed, numbers, st.text(st.characters(exclude_categories=["Cs"]))),
    st.builds(Blocked, numbers, facts),
    st.builds(Observation, facts),
)
messages = st.one_of(
    st.builds(StepMessage, names, names, st.builds(Order, numbers, atoms)),
    st.builds(CancelMessage, names, names, numbers),
    st.builds(HelloMessage, names, st.booleans()),
    st.builds(ReportMessage, names, names, numbers, reports),
)


@given(messages)
def test_messages_come_back_as_they_were(message):
    assert decode_message(encode_message(message)) == message


@given(messages, st.data())
def test_damaged_messages_are_refused_with_a_reason(message, data):
    document = json.loads(encode_message(message))
    key = data.draw(st.sampled_from(sorted(document)))
    wrong = st.sampled_from([None, [], {}, -1, 0, 1.5, 2**53, "", "A b", ["a", 1], [[]], "x" * 300])
    document[key] = data.draw(wrong)
    if key == "reason" and isinstance(document[key], str):
        document["more"] = 1
    if key == "facts" and document[key] == []:
        del document[key]
    with pytest.raises(RobotError):
        decode_message(json.dumps(document).encode())


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"null",
        b"[" * 60000,
        b"\xff\xfe",
        b'{"version": NaN}',
        b'{"version": 1, "version": 1}',
        b'{"version": true, "kind": "hello", "robot": "r1", "connected": true}',
        b'{"version": 1, "kind": "hello", "robot": "r1"}',
        b'{"version": 1, "kind": "hello", "robot": "\\ud800", "connected": true}',
        b'{"version": 1, "kind": "hello", "robot": "r1", "connected": true, "number": 1}',
        b'{"version": 1, "kind": "hello", "robot": "r1", "connected": ' + b"9" * 5000 + b"}",
        b" " * (MAX_BYTES + 1),
    ],
)
def test_what_is_no_message_is_refused(data):
    with pytest.raises(RobotError):
        decode_message(data)


@given(st.binary(max_size=200))
def test_no_bytes_do_harm(data):
    robot = Wired()
    with pytest.raises(RobotError):
        robot.receive(data)
    assert robot.poll() is None


class Wired(RemoteRobot):
    """A robot on a wire that keeps what it is given."""

    def __init__(self):
        super().__init__("r1", "now")
        self.wire = []

    def _transmit(self, message):
        self.wire.append(message)


def report(sequence, content, session="now", robot="r1"):
    return encode_message(ReportMessage(session, robot, sequence, content))


def seen(place):
    return Observation((Fact(("at", "r1", place)),))


@pytest.fixture
def robot():
    robot = Wired()
    robot.receive(encode_message(HelloMessage("r1")))
    return robot


def test_what_is_sent_twice_counts_once_and_what_comes_late_not_at_all(robot):
    assert robot.send(Order(3, FINISHES[0])) == Accepted(3)
    assert robot.receive(report(10, seen("a"))) is Receipt.TAKEN
    assert robot.receive(report(10, seen("a"))) is Receipt.DUPLICATE
    assert robot.receive(report(9, seen("b"))) is Receipt.LATE
    assert robot.receive(report(11, Finished(2))) is Receipt.LATE
    assert robot.receive(report(8, Finished(3))) is Receipt.TAKEN
    assert robot.receive(report(8, Finished(3))) is Receipt.DUPLICATE
    assert robot.receive(report(12, Failed(3, "no"))) is Receipt.LATE
    assert [robot.poll(), robot.poll(), robot.poll()] == [seen("a"), Finished(3), None]


def test_messages_of_others_are_refused(robot):
    robot.send(Order(1, HANGS))
    for data in (
        report(1, Finished(1), session="before"),
        report(1, Finished(1), robot="r2"),
        encode_message(CancelMessage("now", "r1", 1)),
    ):
        with pytest.raises(RobotError):
            robot.receive(data)
    assert robot.state().order == Order(1, HANGS)
    assert robot.poll() is None


def test_observations_nobody_polls_do_not_fill_the_memory(robot):
    receipts = [robot.receive(report(number, seen("a"))) for number in range(1, 1100)]
    assert receipts.count(Receipt.TAKEN) == 1000
    assert receipts[-1] is Receipt.FULL
    robot.send(Order(1, HANGS))
    assert robot.receive(report(2000, Finished(1))) is Receipt.TAKEN


@given(
    st.lists(st.sampled_from(["order", "to robot", "to software", "cancel", "finish", "cut"]), max_size=40)
)
def test_each_order_is_carried_out_at_most_once_and_answered_once_over_a_bad_wire(events):
    """Messages are lost with the connection, and come again; nothing is done twice, nothing is forgotten."""
    robot, to_software, done, answers = Wired(), [], [], []
    side = RobotSide("r1", to_software.append)
    hello = encode_message(HelloMessage("r1"))
    robot.receive(hello)
    number = 0

    def deliver(wire):
        if wire is robot.wire and wire:
            order = side.receive(encode_message(wire.pop(0)))
            done.extend([order.number] if order else [])
        elif wire:
            robot.receive(encode_message(wire.pop(0)))

    for event in [*events, "cut", *["to robot"] * 60, "finish", *["to software"] * 60]:
        if event == "order":
            number += isinstance(robot.send(Order(number + 1, HANGS)), Accepted)
        elif event == "cancel":
            robot.cancel()
        elif event == "finish" and side.order:
            side.report(Failed(side.order.number) if side.cancelled else Finished(side.order.number))
        elif event == "cut":
            robot.wire.clear()
            to_software.clear()
            robot.receive(encode_message(HelloMessage("r1", connected=False)))
            robot.receive(hello)
        else:
            deliver(robot.wire if event == "to robot" else to_software)
        while answer := robot.poll():
            answers.append(answer.number)
    assert robot.state().order is None
    assert answers == list(range(1, number + 1))
    assert done == sorted(set(done))

from contextlib import contextmanager

import pytest
from mosquitto import BrokerProcess
from paho.mqtt.publish import single
from rigs import FINISHES, HANGS, PATIENCE_S, STEPS, scripted_report, until

from explicable.errors import UsageError
from explicable.execution.robots import Accepted, Failed, Finished, Order, Refused
from explicable.execution.robots.conformance import Rig, check
from explicable.execution.robots.messages import ReportMessage, encode_message
from explicable.execution.robots.mqtt import Broker, MqttClient, MqttFleet


@pytest.fixture(scope="module")
def process(tmp_path_factory):
    process = BrokerProcess(tmp_path_factory.mktemp("broker"))
    yield process
    process.end()


def carry_out(side):
    report = Failed(side.order.number, "cancelled") if side.cancelled else scripted_report(side.order)
    if report:
        side.report(report)


@contextmanager
def connected(process, team, carry_out=carry_out):
    broker = Broker(port=process.port, team=team)
    with MqttFleet(broker, ["r1", "r2"]) as fleet, MqttClient(broker, "r1", carry_out) as client:
        until(lambda: fleet.robots["r1"].state().connected)
        yield fleet, client


def test_a_robot_behind_a_broker_conforms(process):
    @contextmanager
    def rig():
        with connected(process, "conforming") as (fleet, _):
            yield Rig(fleet.robots["r1"], **STEPS)

    assert check(rig) == ()


def test_a_robot_that_is_not_there_or_leaves_gets_no_orders(process):
    with connected(process, "leaving") as (fleet, client):
        assert fleet.robots["r2"].send(Order(1, HANGS)) == Refused(1, "not connected")
        client._client.loop_stop()  # it does not come back
        client._client.socket().close()  # it falls silent, without a word; the broker speaks its will
        until(lambda: not fleet.robots["r1"].state().connected)
        assert fleet.robots["r1"].send(Order(1, HANGS)) == Refused(1, "not connected")


def test_a_broker_that_dies_and_returns_loses_no_order_and_no_answer(process):
    done = []
    with connected(process, "dying", lambda side: done.append(side.order.number)) as (fleet, client):
        robot = fleet.robots["r1"]
        assert robot.send(Order(1, FINISHES[0])) == Accepted(1)
        until(lambda: done)
        process.kill()
        until(lambda: not robot.state().connected)
        assert robot.send(Order(2, FINISHES[1])) == Refused(2, "not connected")
        client.side.report(Finished(1))  # into the void
        robot.cancel()
        process.start()
        assert robot.poll(PATIENCE_S) == Finished(1)
        assert robot.state().order is None
        until(lambda: robot.state().connected)
        assert robot.send(Order(2, FINISHES[1])) == Accepted(2)
        until(lambda: done == [1, 2])
        assert robot.poll(0.2) is None


def test_messages_that_are_wrong_or_come_twice_change_nothing(process):
    with connected(process, "noisy", lambda _: None) as (fleet, _):
        robot = fleet.robots["r1"]
        robot.send(Order(1, FINISHES[0]))
        answer = encode_message(ReportMessage(robot.session, "r1", 5, Finished(1)))
        forged = encode_message(ReportMessage("other", "r1", 6, Finished(1)))
        stranger = encode_message(ReportMessage(robot.session, "r2", 6, Finished(1)))
        topic = "explicable/noisy/r1/reports"
        for payload in (b"", b"\xff", b"{" * 100_000, forged, stranger, answer, answer):
            single(topic, payload, qos=1, hostname="127.0.0.1", port=process.port)
        assert robot.poll(PATIENCE_S) == Finished(1)
        until(lambda: fleet.num_refused == 5)
        assert robot.poll() is None


@pytest.mark.parametrize("team", ["", "a/b", "#", "+"])
def test_a_teams_name_is_one_level_of_a_topic(team):
    with pytest.raises(UsageError, match="topic"):
        Broker(team=team)

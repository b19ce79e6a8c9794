import threading
import time
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
import ros_stand_in
from rigs import HANGS, PATIENCE_S, STEPS, scripted_report, until

from explicable.execution.robots import Accepted, Failed, Order, Refused, remote
from explicable.execution.robots.conformance import Rig, check
from explicable.execution.robots.ros import RosClient, RosFleet


@pytest.fixture(autouse=True)
def stand_in(monkeypatch):
    ros_stand_in.install(monkeypatch)


def carry_out(side):
    report = Failed(side.order.number, "cancelled") if side.cancelled else scripted_report(side.order)
    if report:
        side.report(report)


@contextmanager
def robots_node(name, team):
    import rclpy
    from rclpy.executors import SingleThreadedExecutor

    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node(f"node_of_{name}", context=context)
    client = RosClient(node, name, carry_out, team=team)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    try:
        yield client
    finally:
        executor.shutdown()
        thread.join()
        node.destroy_node()


def test_a_robot_behind_the_stand_in_for_ros_conforms():
    @contextmanager
    def rig():
        with robots_node("r1", "team"), RosFleet(["r1"]) as fleet:
            until(lambda: fleet.robots["r1"].state().connected)
            yield Rig(fleet.robots["r1"], **STEPS)

    assert check(rig) == ()


def test_a_node_that_falls_silent_gets_no_orders_and_one_that_returns_its_open_order(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(remote, "time", SimpleNamespace(monotonic=lambda: now[0], time_ns=time.time_ns))
    with RosFleet(["r1"], silence_s=0.5) as fleet:
        robot = fleet.robots["r1"]
        assert robot.send(Order(1, HANGS)) == Refused(1, "not connected")
        with robots_node("r1", "team"):
            until(lambda: robot.state().connected)
            assert robot.send(Order(1, HANGS)) == Accepted(1)
        fleet._node.inbox.join()  # nothing is on its way any more
        assert robot.state().connected
        now[0] = 1.0
        assert not robot.state().connected
        assert robot.send(Order(2, HANGS)) == Refused(2, "not connected")
        with robots_node("r1", "team") as client:
            until(lambda: client.side.order == Order(1, HANGS))
            robot.cancel()
            assert robot.poll(PATIENCE_S) == Failed(1, "cancelled")


def test_noise_on_a_topic_is_counted_and_changes_nothing():
    import rclpy
    from std_msgs.msg import String

    with RosFleet(["r1"]) as fleet:
        context = rclpy.Context()
        rclpy.init(context=context)
        node = rclpy.create_node("noise", context=context)
        publisher = node.create_publisher(String, "/team/r1/reports", 1)
        for noise in ("", "{", "\udcff", "null"):
            publisher.publish(String(data=noise))
        until(lambda: fleet.num_refused == 4)
        assert fleet.robots["r1"].poll() is None

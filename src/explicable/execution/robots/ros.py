"""Robots behind ROS 2: topics of ``std_msgs/String`` that carry the messages of `messages`.

**Not run against ROS 2 itself**, which can't be had from the package indexes: the adapter keeps the protocol
over a stand-in for ``rclpy`` that has the few calls used here. ``rclpy`` and ``std_msgs`` come with a ROS 2
installation and are imported when a fleet is made.

=========================  =============  ===============================================================
topic                      who publishes  what
=========================  =============  ===============================================================
``/TEAM/ROBOT/orders``     the software   ``step``, ``cancel``
``/TEAM/ROBOT/reports``    the robot      ``finished``, ``failed``, ``blocked``, ``observation``
``/TEAM/ROBOT/presence``   the robot      ``hello``, every second or so
=========================  =============  ===============================================================

Delivery is reliable, and an open order is sent again with every hello, so that a node that comes late or
comes back gets it; nodes know what they have done by the order's number.
"""

import threading
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Self

from explicable.errors import RobotError
from explicable.execution.robots.messages import (
    CancelMessage,
    HelloMessage,
    Message,
    ReportMessage,
    StepMessage,
    encode_message,
)
from explicable.execution.robots.remote import RemoteRobot, RobotSide, new_session

if TYPE_CHECKING:
    from rclpy.node import Node
    from std_msgs.msg import String

_QUEUE_DEPTH = 100
HELLO_PERIOD_S = 1.0
"""How often a robot's node should say hello."""


class RosRobot(RemoteRobot):
    """A robot behind ROS 2; made by `RosFleet`."""

    def __init__(
        self, name: str, session: str, silence_s: float, publish: Callable[[Message], object]
    ) -> None:
        super().__init__(name, session, silence_s)
        self._publish = publish

    def _transmit(self, message: StepMessage | CancelMessage) -> None:
        self._publish(message)


class RosFleet:
    """The robots of a team behind ROS 2; a context manager with a node and a thread of its own.

    Parameters
    ----------
    names
        The robots.
    team
        The first part of the topics.
    silence_s
        Robots that have not said hello for longer than this are not connected.

    Attributes
    ----------
    robots
        The robots by name, for `Door`.
    num_refused
        Messages that were malformed, from another session or for another robot.

    Raises
    ------
    ImportError
        Without ROS 2.
    """

    def __init__(self, names: Iterable[str], *, team: str = "team", silence_s: float = 5.0) -> None:
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        self.num_refused = 0
        self._context = rclpy.Context()
        rclpy.init(context=self._context)
        self._node = rclpy.create_node("explicable", context=self._context)
        session = new_session()
        self.robots = {}
        for name in names:
            publish = _publisher(self._node, f"/{team}/{name}/orders")
            robot = self.robots[name] = RosRobot(name, session, silence_s, publish)
            for what in ("reports", "presence"):
                _subscribe(self._node, f"/{team}/{name}/{what}", self._receiver(robot))
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, name="robots' ROS node", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close every robot and end the node."""
        for robot in self.robots.values():
            robot.close()
        self._executor.shutdown()
        self._thread.join(timeout=10)
        self._node.destroy_node()
        self._context.try_shutdown()

    def _receiver(self, robot: RosRobot) -> Callable[[bytes], None]:
        def receive(data: bytes) -> None:
            try:
                robot.receive(data)
            except RobotError:
                self.num_refused += 1

        return receive


class RosClient:
    """The robot's end, on a node of the robot's own, which spins it.

    Parameters
    ----------
    node
        An ``rclpy`` node.
    name, team
        The robot, and its team.
    carry_out
        Called with each new order and each cancelled one, where the node's callbacks run; answer through
        ``side.report``, there or from elsewhere.
    """

    def __init__(
        self, node: "Node", name: str, carry_out: Callable[[RobotSide], object], *, team: str = "team"
    ) -> None:
        publish: Callable[[ReportMessage], None] = _publisher(node, f"/{team}/{name}/reports")
        self.side = RobotSide(name, publish)
        self.num_refused = 0
        self._carry_out = carry_out
        say = _publisher(node, f"/{team}/{name}/presence")
        _subscribe(node, f"/{team}/{name}/orders", self._receive)
        node.create_timer(HELLO_PERIOD_S, lambda: say(HelloMessage(name)))

    def _receive(self, data: bytes) -> None:
        try:
            order = self.side.receive(data)
        except RobotError:
            self.num_refused += 1
            return
        if order is not None or (self.side.order is not None and self.side.cancelled):
            self._carry_out(self.side)


def _publisher(node: "Node", topic: str) -> Callable[[Message], None]:
    from std_msgs.msg import String

    publisher = node.create_publisher(String, topic, _QUEUE_DEPTH)

    def publish(message: Message) -> None:
        publisher.publish(String(data=encode_message(message).decode()))

    return publish


def _subscribe(node: "Node", topic: str, receive: Callable[[bytes], None]) -> None:
    from std_msgs.msg import String

    def take(message: "String") -> None:
        receive(message.data.encode("utf-8", "surrogateescape"))

    node.create_subscription(String, topic, take, _QUEUE_DEPTH)

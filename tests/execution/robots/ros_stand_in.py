"""A stand-in for the part of rclpy that the adapter uses; nodes of one process talk to each other.

ROS 2 itself can't be installed from the package indexes. Signatures follow rclpy of ROS 2 Jazzy.
"""

import queue
import sys
import threading
from dataclasses import dataclass
from types import ModuleType


@dataclass
class String:
    data: str = ""


class Context:
    def __init__(self):
        self.is_up = False

    def try_shutdown(self):
        self.is_up = False


class Bus:
    """All nodes, and who listens to what."""

    def __init__(self):
        self.listeners = {}

    def init(self, *, context):
        context.is_up = True

    def create_node(self, name, *, context):
        assert context.is_up, "rclpy.init() has not been called"
        return Node(name, self)


class Node:
    def __init__(self, name, bus):
        self.name, self.bus = name, bus
        self.inbox = queue.Queue()
        self.timers = []

    def create_publisher(self, kind, topic, qos):
        assert kind is String
        assert qos > 0
        return Publisher(self.bus, topic)

    def create_subscription(self, kind, topic, callback, qos):
        assert kind is String
        assert qos > 0
        self.bus.listeners.setdefault(topic, []).append((self, callback))

    def create_timer(self, period_s, callback):
        assert period_s > 0
        self.timers.append(callback)

    def destroy_node(self):
        for listeners in self.bus.listeners.values():
            listeners[:] = [(node, callback) for node, callback in listeners if node is not self]


class Publisher:
    def __init__(self, bus, topic):
        self.bus, self.topic = bus, topic

    def publish(self, message):
        assert type(message.data) is str
        for node, callback in list(self.bus.listeners.get(self.topic, ())):
            node.inbox.put((callback, message))


class SingleThreadedExecutor:
    def __init__(self, *, context):
        assert context.is_up
        self.nodes, self.ended = [], threading.Event()

    def add_node(self, node):
        self.nodes.append(node)

    def spin(self):
        """Timers fire whenever nothing else is to do."""
        while not self.ended.is_set():
            for node in self.nodes:
                try:
                    callback, message = node.inbox.get(timeout=0.01)
                except queue.Empty:
                    for fire in node.timers:
                        fire()
                else:
                    try:
                        callback(message)
                    finally:
                        node.inbox.task_done()

    def shutdown(self):
        self.ended.set()


def install(monkeypatch):
    """Let ``import rclpy`` find the stand-in."""
    bus = Bus()
    contents = {
        "rclpy": {"Context": Context, "init": bus.init, "create_node": bus.create_node},
        "rclpy.executors": {"SingleThreadedExecutor": SingleThreadedExecutor},
        "std_msgs": {},
        "std_msgs.msg": {"String": String},
    }
    for name, content in contents.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)

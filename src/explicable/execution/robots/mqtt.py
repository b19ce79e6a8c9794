"""Robots behind an MQTT broker.

==================================  =============  ========================================================
topic                               who publishes  what
==================================  =============  ========================================================
``explicable/TEAM/ROBOT/orders``    the software   ``step``, ``cancel``
``explicable/TEAM/ROBOT/reports``   the robot      ``finished``, ``failed``, ``blocked``, ``observation``
``explicable/TEAM/ROBOT/presence``  the robot      ``hello``; retained; as last will, ``connected: false``
``explicable/TEAM/software``        the software   the word ``online``; retained; as last will, ``offline``
==================================  =============  ========================================================

Everything goes with quality of service 1: it may come twice, which the numbers and sequences of the messages
take care of. Both sides come back by themselves when the broker does. It forgets what it had not passed on,
so the software then sends its open orders again, and the robot its last answer.
"""

import contextlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from explicable.errors import RobotError, UsageError
from explicable.execution.robots.messages import (
    CancelMessage,
    HelloMessage,
    ReportMessage,
    StepMessage,
    encode_message,
)
from explicable.execution.robots.remote import RemoteRobot, RobotSide, new_session

if TYPE_CHECKING:
    from paho.mqtt.client import Client, MQTTMessage

_QOS = 1
_KEEP_ALIVE_S = 20


@dataclass(frozen=True, slots=True)
class Broker:
    """Where the broker is, and how to get in.

    Parameters
    ----------
    host, port
        Its address.
    team
        The part of the topics by which teams on one broker are told apart.
    user, password
        If it wants them. The broker's access lists are what keeps others from publishing as a robot.
    ca_file
        Certificates to trust; given, the connection is encrypted.
    """

    host: str = "127.0.0.1"
    port: int = 1883
    team: str = "team"
    user: str | None = None
    password: str | None = None
    ca_file: str | None = None

    def __post_init__(self) -> None:
        if not self.team or set(self.team) & set("/+#"):
            raise UsageError(f"a team's name is one level of a topic, not {self.team!r}")

    def topic(self, robot: str, what: str) -> str:
        """Return a robot's topic."""
        return f"explicable/{self.team}/{robot}/{what}"

    @property
    def software_topic(self) -> str:
        """Where the software says whether it is there."""
        return f"explicable/{self.team}/software"


class MqttRobot(RemoteRobot):
    """A robot behind a broker; made by `MqttFleet`."""

    def __init__(self, name: str, session: str, publish: Callable[[bytes], object]) -> None:
        super().__init__(name, session)
        self._publish = publish

    def _transmit(self, message: StepMessage | CancelMessage) -> None:
        self._publish(encode_message(message))

    def lose(self) -> None:
        """Note that the robot is out of reach, until it is heard again."""
        with self._lock:
            self._set_connected(connected=False)


class MqttFleet:
    """The robots of a team behind a broker; a context manager.

    It connects in the background, and again whenever the connection breaks.

    Parameters
    ----------
    broker
        The broker.
    names
        The robots.

    Attributes
    ----------
    robots
        The robots by name, for `Door`.
    num_refused
        Messages that were malformed, from another session or for another robot.
    """

    def __init__(self, broker: Broker, names: Iterable[str]) -> None:
        session = new_session()
        self._broker = broker
        self._client = _make_client(broker, will=(broker.software_topic, b"offline"))
        self.num_refused = 0
        self.robots = {
            name: MqttRobot(name, session, self._publisher(broker.topic(name, "orders"))) for name in names
        }
        self._by_topic = {
            broker.topic(name, what): robot
            for name, robot in self.robots.items()
            for what in ("reports", "presence")
        }
        self._client.on_connect = self._subscribe
        self._client.on_disconnect = self._lose
        self._client.on_message = self._receive
        _start(self._client, broker)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Say that the software is gone, and leave."""
        for robot in self.robots.values():
            robot.close()
        _stop(self._client, (self._broker.software_topic, b"offline"))

    def _publisher(self, topic: str) -> Callable[[bytes], object]:
        return lambda payload: self._client.publish(topic, payload, qos=_QOS)

    def _subscribe(self, client: "Client", *_: object) -> None:
        # Presence is retained: each robot that is there is heard of at once, and gets its open order again.
        client.subscribe([(topic, _QOS) for topic in self._by_topic])
        client.publish(self._broker.software_topic, b"online", qos=_QOS, retain=True)

    def _lose(self, *_: object) -> None:
        for robot in self.robots.values():
            robot.lose()

    def _receive(self, _client: "Client", _data: object, message: "MQTTMessage") -> None:
        robot = self._by_topic[message.topic]
        try:
            robot.receive(bytes(message.payload))
        except RobotError:
            self.num_refused += 1


class MqttClient:
    """The robot's end; connects in the background. A context manager.

    Parameters
    ----------
    broker
        The broker.
    name
        The robot.
    carry_out
        Called with each new order and each cancelled one, in the client's own thread; answer through
        ``side.report``, there or from elsewhere.

    Attributes
    ----------
    side
        What has been ordered and answered.
    """

    def __init__(self, broker: Broker, name: str, carry_out: Callable[[RobotSide], object]) -> None:
        self._broker, self._name, self._carry_out = broker, name, carry_out
        self._presence = broker.topic(name, "presence")
        self._gone = (self._presence, encode_message(HelloMessage(name, connected=False)))
        # Under the same name, a new connection ends an old one, and its will is spoken before the new hello.
        self._client = _make_client(broker, self._gone, f"explicable {broker.team} {name}")
        self.side = RobotSide(name, self._emit)
        self.num_refused = 0
        self._client.on_connect = self._subscribe
        self._client.on_message = self._receive
        _start(self._client, broker)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Say that the robot is gone, and leave."""
        _stop(self._client, self._gone)

    def _emit(self, message: ReportMessage) -> None:
        self._client.publish(self._broker.topic(self._name, "reports"), encode_message(message), qos=_QOS)

    def _subscribe(self, client: "Client", *_: object) -> None:
        client.subscribe(self._broker.topic(self._name, "orders"), _QOS)
        client.publish(self._presence, encode_message(HelloMessage(self._name)), qos=_QOS, retain=True)
        self.side.repeat()

    def _receive(self, _client: "Client", _data: object, message: "MQTTMessage") -> None:
        try:
            order = self.side.receive(bytes(message.payload))
        except RobotError:
            self.num_refused += 1
            return
        if order is not None or (self.side.order is not None and self.side.cancelled):
            self._carry_out(self.side)


def _make_client(broker: Broker, will: tuple[str, bytes], client_id: str = "") -> "Client":
    from paho.mqtt.client import Client
    from paho.mqtt.enums import CallbackAPIVersion

    client = Client(CallbackAPIVersion.VERSION2, client_id=client_id)
    client.will_set(*will, qos=_QOS, retain=True)
    client.reconnect_delay_set(min_delay=1, max_delay=10)
    client.max_queued_messages_set(1000)
    if broker.user is not None:
        client.username_pw_set(broker.user, broker.password)
    if broker.ca_file is not None:
        client.tls_set(broker.ca_file)
    return client


def _start(client: "Client", broker: Broker) -> None:
    client.connect_async(broker.host, broker.port, keepalive=_KEEP_ALIVE_S)
    client.loop_start()


def _stop(client: "Client", farewell: tuple[str, bytes]) -> None:
    if client.is_connected():
        with contextlib.suppress(
            RuntimeError, ValueError
        ):  # the connection broke meanwhile; the will does it
            client.publish(*farewell, qos=_QOS, retain=True).wait_for_publish(timeout=5)
    client.disconnect()
    client.loop_stop()

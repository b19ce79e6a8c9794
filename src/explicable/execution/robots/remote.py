"""What all robots at the end of a wire have in common, whatever the wire.

Wires lose nothing but may bring a message twice, late, or after one's own restart. Orders are known by their
number, reports by their sequence; both sides send again what may have got lost when a connection comes back.
"""

import math
import queue
import secrets
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from enum import StrEnum

from explicable.errors import RobotError
from explicable.execution.robots.messages import (
    CancelMessage,
    HelloMessage,
    ReportMessage,
    StepMessage,
    decode_message,
)
from explicable.execution.robots.protocol import (
    Accepted,
    Answer,
    Blocked,
    Failed,
    Finished,
    Observation,
    Order,
    OrderBook,
    Refused,
    Report,
    RobotState,
)

_MAX_WAITING = 1000
"""Observations that wait to be polled; answers to orders always find room."""


class Receipt(StrEnum):
    """What became of a robot's message."""

    TAKEN = "taken"
    DUPLICATE = "duplicate"
    LATE = "late"
    FULL = "full"


def new_session() -> str:
    """Make up the name of a session; later ones come later in the alphabet."""
    return f"{time.time_ns():020}-{secrets.token_hex(4)}"


class RemoteRobot(ABC):
    """A robot whose messages another thread brings in through `receive`.

    Parameters
    ----------
    name
        The agent that it is.
    session
        By which its messages are told from those of other runs.
    silence_s
        A robot unheard of for longer than this is not connected.
    """

    def __init__(self, name: str, session: str, silence_s: float = math.inf) -> None:
        self.name = name
        self.session = session
        self._lock = threading.RLock()
        self._book = OrderBook()
        self._cancelled = self._closed = False
        self._connected = False
        self._silence_s, self._heard_at = silence_s, 0.0
        self._reports: queue.SimpleQueue[Report] = queue.SimpleQueue()
        self._last_answer = self._last_observation = 0  # their sequences

    @abstractmethod
    def _transmit(self, message: StepMessage | CancelMessage) -> None:
        """Put a message on the wire; without waiting, and without raising if the wire is down."""

    def send(self, order: Order) -> Answer:
        """Hand an order over, unless the robot is out of reach or busy."""
        with self._lock:
            if not self.state().connected:
                return Refused(order.number, "closed" if self._closed else "not connected")
            answer = self._book.open(order)
            if isinstance(answer, Accepted):
                self._cancelled = False
                self._transmit(StepMessage(self.session, self.name, order))
            return answer

    def poll(self, timeout_s: float = 0.0) -> Report | None:
        """Return the next report, after waiting for one if need be."""
        if self._closed:
            return None
        try:
            return self._reports.get(block=timeout_s > 0, timeout=timeout_s or None)
        except queue.Empty:
            return None

    def cancel(self) -> None:
        """Ask the robot to give its open order up."""
        with self._lock:
            if self._book.order is not None and not self._cancelled and not self._closed:
                self._cancelled = True
                self._transmit(CancelMessage(self.session, self.name, self._book.order.number))

    def state(self) -> RobotState:
        """Tell where the robot stands; an order is open until its answer has come over the wire."""
        with self._lock:
            if time.monotonic() - self._heard_at > self._silence_s:
                self._connected = False
            return RobotState(self._connected and not self._closed, self._book.order)

    def close(self) -> None:
        """Be silent from now on."""
        with self._lock:
            self._closed = True

    def receive(self, data: bytes) -> Receipt:
        """Take a message that the wire has brought.

        Raises
        ------
        RobotError
            If it is malformed, or not from this robot in this session. Nothing has changed then.
        """
        message = decode_message(data)
        if isinstance(message, StepMessage | CancelMessage):
            raise RobotError("this is a message to a robot")
        if message.robot != self.name:
            raise RobotError(f"this is not robot {message.robot}")
        with self._lock:
            if isinstance(message, HelloMessage):
                self._connected = False  # what was on the wire before a hello may be lost
                self._set_connected(message.connected)
                return Receipt.TAKEN
            if message.session != self.session:
                raise RobotError("this message is from another session")
            self._set_connected(connected=True)
            return self._take(message)

    def _take(self, message: ReportMessage) -> Receipt:
        report, sequence = message.report, message.sequence
        if isinstance(report, Observation):
            if sequence <= self._last_observation:  # it would overwrite what has been seen since
                return Receipt.DUPLICATE if sequence == self._last_observation else Receipt.LATE
            if self._reports.qsize() >= _MAX_WAITING:
                return Receipt.FULL
            self._last_observation = sequence
        else:
            if not self._book.answer(report.number):
                return Receipt.DUPLICATE if sequence == self._last_answer else Receipt.LATE
            self._last_answer = sequence
        self._reports.put(report)
        return Receipt.TAKEN

    def _set_connected(self, connected: bool) -> None:
        returned = connected and not self._connected
        self._connected = connected
        if connected:
            self._heard_at = time.monotonic()
        order = self._book.order
        if returned and order is not None and not self._closed:
            # The robot may never have got these; if it has, it knows them by their number.
            self._transmit(StepMessage(self.session, self.name, order))
            if self._cancelled:
                self._transmit(CancelMessage(self.session, self.name, order.number))


class RobotSide:
    """The other end: what a robot, or the node that drives it, does with the messages it gets.

    It gives each order out once and sends the answer again when it is asked again. Any thread may call it.

    Parameters
    ----------
    name
        The robot.
    emit
        Puts a message on the wire.

    Examples
    --------
    >>> from explicable.execution.robots.messages import encode_message
    >>> sent = []
    >>> side = RobotSide("r1", sent.append)
    >>> step = encode_message(StepMessage("s1", "r1", Order(1, ("wait", "r1"))))
    >>> side.receive(step)
    Order(number=1, action=('wait', 'r1'))
    >>> side.report(Finished(1))
    >>> side.receive(step) is None, sent[0].report == sent[1].report
    (True, True)
    """

    def __init__(self, name: str, emit: Callable[[ReportMessage], None]) -> None:
        self.name = name
        self.session: str | None = None
        self.order: Order | None = None
        self.cancelled = False
        self._emit = emit
        self._lock = threading.RLock()
        self._answered = 0
        self._answer: ReportMessage | None = None
        self._sequence = 0

    def receive(self, data: bytes) -> Order | None:
        """Take a message; returns the order if there is a new one to carry out.

        A cancelled order shows in ``cancelled``; it wants an answer like every other. The first message of
        another session ends what was left of the one before.

        Raises
        ------
        RobotError
            If the message is malformed, for another robot, or from a session before the present one.
        """
        message = decode_message(data)
        if not isinstance(message, StepMessage | CancelMessage) or message.robot != self.name:
            raise RobotError(f"this is no order for {self.name}")
        with self._lock:
            return self._take(message)

    def report(self, report: Report) -> None:
        """Send a report; an answer to the order under way frees the robot for the next one.

        An answer to any other order, such as one of a session that is over, goes nowhere.
        """
        with self._lock:
            if isinstance(report, Observation):
                if self.session is not None:
                    self._emit(self._message(report))
            elif self.order is not None and self.order.number == report.number:
                self._conclude(report)

    def repeat(self) -> None:
        """Send the last answer again, after a connection was lost."""
        with self._lock:
            if self._answer is not None:
                self._emit(self._answer)

    def _take(self, message: StepMessage | CancelMessage) -> Order | None:
        if self.session is not None and message.session < self.session:
            raise RobotError("this order is from a session that is over")
        if message.session != self.session:
            self.session, self.order, self.cancelled = message.session, None, False
            self._answered, self._answer = 0, None
        number = message.order.number if isinstance(message, StepMessage) else message.number
        if number <= self._answered:
            if self._answer is not None and number == self._answered:
                self._emit(self._answer)
            return None
        if isinstance(message, StepMessage) and self.order is None:
            self.order, self.cancelled = message.order, False
            return self.order
        if isinstance(message, CancelMessage):
            if self.order is None:  # the step has not come yet; if it does, this answers it
                self._conclude(Failed(number, "cancelled"))
            elif self.order.number == number:
                self.cancelled = True
        return None

    def _conclude(self, answer: Finished | Failed | Blocked) -> None:
        self.order, self._answered, self._answer = None, answer.number, self._message(answer)
        self._emit(self._answer)

    def _message(self, report: Report) -> ReportMessage:
        self._sequence = max(self._sequence + 1, time.time_ns() // 1_000_000)
        return ReportMessage(self.session or "", self.name, self._sequence, report)

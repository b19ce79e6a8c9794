r"""The messages on every wire, REST, MQTT or ROS 2: JSON objects with a version, one kind each.

To the robot go ``step`` and ``cancel``; from it come ``finished``, ``failed``, ``blocked``, ``observation``
and ``hello``. Each names its robot and its *session*, which one run of the software makes up, so that what is
left over from another is recognised. Each report carries a *sequence*, any whole number that rises with every
new report (milliseconds since 1970 will do), so that what is sent twice is recognised.
The page ``docs/robots.md`` shows each kind.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from explicable.errors import RobotError
from explicable.execution.robots.protocol import (
    Blocked,
    Fact,
    Failed,
    Finished,
    Observation,
    Order,
    Report,
    facts_of,
)
from explicable.model.problem import GroundAtom
from explicable.model.strict_json import parse_json

VERSION = 1
MAX_BYTES = 64 * 1024
"""Longest message that is read."""
_MAX_NUMBER = 2**53
_NAME = re.compile(r"[^\s();\"]{1,200}")
_TOKEN = re.compile(r"[\w.-]{1,100}")


Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class StepMessage:
    """To a robot: carry a step out."""

    session: str
    robot: str
    order: Order


@dataclass(frozen=True, slots=True)
class CancelMessage:
    """To a robot: give an order up, and say how it ended."""

    session: str
    robot: str
    number: int


@dataclass(frozen=True, slots=True)
class HelloMessage:
    """From a robot: it is there; with ``connected=False`` (a last will), it is not."""

    robot: str
    connected: bool = True


@dataclass(frozen=True, slots=True)
class ReportMessage:
    """From a robot: a report."""

    session: str
    robot: str
    sequence: int
    report: Report


Message = StepMessage | CancelMessage | HelloMessage | ReportMessage


def encode_message(message: Message) -> bytes:
    """Write a message.

    Examples
    --------
    >>> encode_message(CancelMessage("s1", "r1", 3))
    b'{"version": 1, "kind": "cancel", "session": "s1", "robot": "r1", "number": 3}'
    """
    data: dict[str, Any] = {"version": VERSION, "kind": _kind(message)}
    if isinstance(message, HelloMessage):
        data |= {"robot": message.robot, "connected": message.connected}
        return json.dumps(data).encode()
    data |= {"session": message.session, "robot": message.robot}
    if isinstance(message, StepMessage):
        data |= {"number": message.order.number, "action": message.order.action}
    elif isinstance(message, CancelMessage):
        data |= {"number": message.number}
    else:
        report = message.report
        data["sequence"] = message.sequence
        if not isinstance(report, Observation):
            data["number"] = report.number
        if isinstance(report, Failed):
            data["reason"] = report.reason
        else:
            data["facts"] = [{"atom": fact.atom, "true": fact.true} for fact in facts_of(report)]
    return json.dumps(data).encode()


def decode_message(data: bytes) -> Message:
    """Read a message.

    Raises
    ------
    RobotError
        If it is too long, no JSON, of another version, or lacks or adds a key; says which.

    Examples
    --------
    >>> decode_message(b'{"version": 1, "kind": "hello", "robot": "r1", "connected": true}')
    HelloMessage(robot='r1', connected=True)
    >>> decode_message(b'{"version": 2}')
    Traceback (most recent call last):
    explicable.errors.RobotError: version must be 1, not 2
    """
    return _Reader(_parse(data)).message()


def message_tag(message: Message) -> str:
    """Return the name by which a message to a robot is told from the others of a session.

    Examples
    --------
    >>> message_tag(CancelMessage("s1", "r1", 3))
    'cancel-3'
    """
    if isinstance(message, StepMessage):
        return f"step-{message.order.number}"
    return f"cancel-{message.number}" if isinstance(message, CancelMessage) else ""


def _kind(message: Message) -> str:
    if isinstance(message, ReportMessage):
        return type(message.report).__name__.lower()
    return type(message).__name__.removesuffix("Message").lower()


def _parse(data: bytes) -> dict[str, Any]:
    if len(data) > MAX_BYTES:
        raise RobotError(f"a message has at most {MAX_BYTES} bytes, not {len(data)}")
    try:
        value = parse_json(data.decode())
    except UnicodeError as error:
        raise RobotError(f"not UTF-8 ({error})") from error
    except (ValueError, RecursionError) as error:
        raise RobotError(f"not JSON ({error})") from error
    if not isinstance(value, dict):
        raise RobotError("a message is a JSON object")
    return value


class _Reader:
    """Takes a message apart; what has been taken is gone, what is left over is refused."""

    def __init__(self, data: dict[str, Any]) -> None:
        self.data = dict(data)

    def message(self) -> Message:
        version = self.data.pop("version", None)
        if version != VERSION or isinstance(version, bool):
            raise RobotError(f"version must be {VERSION}, not {_show(version)}")
        kind = self.take("kind", str)
        message = self.body(kind)
        if self.data:
            raise RobotError(f"{kind} has no {_show(min(self.data))}")
        return message

    def body(self, kind: str) -> Message:
        if kind == "hello":
            return HelloMessage(self.name("robot"), self.take("connected", bool))
        session, robot = self.token("session"), self.name("robot")
        if kind == "step":
            return StepMessage(session, robot, Order(self.number("number"), self.atom("action")))
        if kind == "cancel":
            return CancelMessage(session, robot, self.number("number"))
        return ReportMessage(session, robot, self.number("sequence"), self.report(kind))

    def report(self, kind: str) -> Report:
        if kind == "observation":
            return Observation(self.facts())
        if kind == "finished":
            return Finished(self.number("number"), self.facts())
        if kind == "blocked":
            return Blocked(self.number("number"), self.facts())
        if kind == "failed":
            return Failed(self.number("number"), self.take("reason", str))
        raise RobotError(f"unknown kind {_show(kind)}")

    def take(self, key: str, kind: type[Value]) -> Value:
        if key not in self.data:
            raise RobotError(f"{key} is missing")
        value = self.data.pop(key)
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise RobotError(f"{key} must be of type {kind.__name__}, not {_show(value)}")
        return value

    def number(self, key: str) -> int:
        number: int = self.take(key, int)
        if not 1 <= number < _MAX_NUMBER:
            raise RobotError(f"{key} must be between 1 and 2^53, not {_show(number)}")
        return number

    def name(self, key: str) -> str:
        return _name(key, self.take(key, str))

    def token(self, key: str) -> str:
        token: str = self.take(key, str)
        if not _TOKEN.fullmatch(token):
            raise RobotError(f"{key} must be letters, digits, '.', '_' and '-', not {_show(token)}")
        return token

    def atom(self, key: str) -> GroundAtom:
        return _atom(key, self.take(key, list))

    def facts(self) -> tuple[Fact, ...]:
        return tuple(_fact(value) for value in self.take("facts", list))


def _fact(value: object) -> Fact:
    if not isinstance(value, Mapping) or set(value) != {"atom", "true"} or type(value["true"]) is not bool:
        raise RobotError(f"a fact has an atom and whether it is true, unlike {_show(value)}")
    return Fact(_atom("atom", value["atom"]), value["true"])


def _atom(key: str, value: object) -> GroundAtom:
    if not isinstance(value, list) or not 1 <= len(value) <= 100:
        raise RobotError(f"{key} must be a list of names, not {_show(value)}")
    return tuple(_name(key, name) for name in value)


def _name(key: str, value: object) -> str:
    if not isinstance(value, str) or not _NAME.fullmatch(value) or value != value.lower():
        raise RobotError(f"{key} must be a lower-case PDDL name, not {_show(value)}")
    return value


def _show(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."

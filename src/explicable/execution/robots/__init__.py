"""Robots: the protocol, the door that checks what they report, adapters, and the checks for adapters."""

from explicable.execution.robots.door import Door, Objection, find_objection
from explicable.execution.robots.protocol import (
    Accepted,
    Answer,
    Blocked,
    Fact,
    Failed,
    Finished,
    Observation,
    Order,
    OrderBook,
    Refused,
    Report,
    Robot,
    RobotState,
    facts_of,
)
from explicable.execution.robots.simulator import SimulatedRobot, SimulatedWorld

__all__ = [
    "Accepted",
    "Answer",
    "Blocked",
    "Door",
    "Fact",
    "Failed",
    "Finished",
    "Objection",
    "Observation",
    "Order",
    "OrderBook",
    "Refused",
    "Report",
    "Robot",
    "RobotState",
    "SimulatedRobot",
    "SimulatedWorld",
    "facts_of",
    "find_objection",
]

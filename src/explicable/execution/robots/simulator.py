"""Robots that are software: one world, in which each step takes its time and can go wrong as told."""

import time
from collections.abc import Callable
from typing import Protocol

from explicable.execution.robots.protocol import (
    Accepted,
    Answer,
    Blocked,
    Fact,
    Failed,
    Finished,
    Order,
    OrderBook,
    Refused,
    Report,
    RobotState,
)
from explicable.model.problem import GroundAtom
from explicable.model.task import Task

Duration = Callable[[GroundAtom], float]
"""How long a step takes, in seconds."""


class ActedWorld(Protocol):
    """What simulated robots act in."""

    def take(self, action: GroundAtom) -> bool:
        """Carry a step out; False if it is not possible, and then nothing has changed."""

    def hindrances(self, action: GroundAtom) -> tuple[Fact, ...]:
        """Return the facts that are in the way of a step, as far as they can be named."""


class SimulatedWorld:
    """What is really so; several simulated robots share one.

    Parameters
    ----------
    task
        The truth.

    Attributes
    ----------
    state
        The present state. People's steps come true by `take`, as those of robots.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.state = task.initial_state

    def take(self, action: GroundAtom) -> bool:
        """Carry a step out; False if it is not possible, and then nothing has changed."""
        for operator in self.task.operators_of(action):
            if self.task.is_applicable(self.state, operator):
                self.state = self.task.successor(self.state, operator)
                return True
        return False

    def hindrances(self, action: GroundAtom) -> tuple[Fact, ...]:
        """Return the facts that are in the way of a step; of one with alternatives, of the first."""
        return tuple(
            _denial(self.task.fact(fact))
            for operator in self.task.operators_of(action)[:1]
            for fact in self.task.core.preconditions(operator)
            if not self.task.core.holds(self.state, [fact])
        )


class SimulatedRobot:
    """A robot in a simulated world.

    Parameters
    ----------
    name
        The agent that it is.
    world
        Where it acts; its steps come true at their end.
    duration
        How long a step takes; by default no time at all.
    clock
        Gives the time in seconds. With a clock that the caller winds, `poll` never waits.
    fault
        Why a step fails, asked once when it ends; None if it does not.
    """

    def __init__(
        self,
        name: str,
        world: ActedWorld,
        *,
        duration: Duration = lambda _: 0.0,
        clock: Callable[[], float] | None = None,
        fault: Callable[[GroundAtom], str | None] = lambda _: None,
    ) -> None:
        self.name = name
        self._world, self._duration = world, duration
        self._clock, self._waits = clock or time.monotonic, clock is None
        self._fault = fault
        self._book = OrderBook()
        self._ends_at = 0.0
        self._cancelled = self._closed = False

    def send(self, order: Order) -> Answer:
        """Begin a step."""
        if self._closed:
            return Refused(order.number, "closed")
        answer = self._book.open(order)
        if isinstance(answer, Accepted):
            self._ends_at = self._clock() + self._duration(order.action)
            self._cancelled = False
        return answer

    def poll(self, timeout_s: float = 0.0) -> Report | None:
        """Return the next report."""
        if self._closed:
            return None
        order = self._book.order
        if order is None:
            if self._waits:
                time.sleep(timeout_s)
            return None
        if self._cancelled:
            self._book.answer(order.number)
            return Failed(order.number, "cancelled")
        if self._waits:
            time.sleep(min(timeout_s, max(0.0, self._ends_at - self._clock())))
        return self._end(order) if self._clock() >= self._ends_at else None

    def cancel(self) -> None:
        """Give the step up."""
        self._cancelled = True

    def state(self) -> RobotState:
        """Tell where the robot stands."""
        return RobotState(not self._closed, self._book.order)

    def close(self) -> None:
        """Stop."""
        self._closed = True

    def _end(self, order: Order) -> Report:
        self._book.answer(order.number)
        reason = self._fault(order.action)
        if reason is not None:
            return Failed(order.number, reason)
        if self._world.take(order.action):
            return Finished(order.number)
        facts = self._world.hindrances(order.action)
        return Blocked(order.number, facts) if facts else Failed(order.number, "not possible here")


def _denial(precondition: GroundAtom) -> Fact:
    """Return what is so where a precondition is lacking."""
    return Fact(precondition[1:]) if precondition[0] == "not" else Fact(precondition, true=False)

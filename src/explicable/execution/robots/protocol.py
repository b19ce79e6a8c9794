"""What the software and a robot say to each other.

A robot does one step at a time. `Robot.send` hands it an *order*, a step with a number; nothing waits for the
robot there. What the robot has to say comes later, as *reports*, from `Robot.poll`. The rules, which
`explicable.execution.robots.conformance` checks of an adapter:

1. The numbers of orders rise. An order is *open* until the robot has answered it by one `Finished`, `Failed`
   or `Blocked`. An order that fails or is blocked has changed nothing.
2. While an order is open, another is refused, and so is one whose number is not new. A refused order never
   reaches the robot.
3. `Observation` tells what the robot saw besides, at any time.
4. `Robot.cancel` asks the robot to give its open order up. The order is still answered: by `Finished` if it
   was too late. Whoever tires of waiting for that takes the robot for lost; what it has done is unknown.
5. `Robot.poll` waits no longer than told and gives reports in the robot's order, each once.
6. After `Robot.close`, which may be called twice, orders are refused and nothing is reported any more.

Nothing here raises when a robot, a wire or a broker fails: that is what `Refused` and `RobotState` are for.
What a robot says is not believed before `explicable.execution.robots.door.Door` has looked at it.
"""

from dataclasses import dataclass
from typing import Protocol

from explicable.model.problem import GroundAtom


@dataclass(frozen=True, slots=True)
class Fact:
    """An atom, and whether it is true.

    Examples
    --------
    >>> print(Fact(("clear", "c-1-2"), true=False))
    (not (clear c-1-2))
    """

    atom: GroundAtom
    true: bool = True

    def __str__(self) -> str:
        text = f"({' '.join(self.atom)})"
        return text if self.true else f"(not {text})"


@dataclass(frozen=True, slots=True)
class Order:
    """A step to carry out.

    Parameters
    ----------
    number
        Counted from 1; higher than that of every order before.
    action
        ``(schema, object, ...)``.
    """

    number: int
    action: GroundAtom


@dataclass(frozen=True, slots=True)
class Accepted:
    """The order is on its way to the robot, or with it."""

    number: int


@dataclass(frozen=True, slots=True)
class Refused:
    """The order does not reach the robot; ``reason`` is for people to read."""

    number: int
    reason: str


Answer = Accepted | Refused


@dataclass(frozen=True, slots=True)
class Finished:
    """An order was carried out; what else was seen stands in ``facts``."""

    number: int
    facts: tuple[Fact, ...] = ()


@dataclass(frozen=True, slots=True)
class Failed:
    """An order was not carried out and changed nothing; also the answer to a `Robot.cancel` in time."""

    number: int
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Blocked:
    """An order was not carried out and changed nothing, since these facts are so."""

    number: int
    facts: tuple[Fact, ...]


@dataclass(frozen=True, slots=True)
class Observation:
    """Facts that the robot has seen to be so."""

    facts: tuple[Fact, ...]


Report = Finished | Failed | Blocked | Observation


@dataclass(frozen=True, slots=True)
class RobotState:
    """Where a robot stands, as far as this side of the wire knows.

    Parameters
    ----------
    connected
        Whether it can be reached now.
    order
        The order that is open, if any.
    """

    connected: bool
    order: Order | None = None


class Robot(Protocol):
    """One robot of the team. Its methods are called by one thread."""

    @property
    def name(self) -> str:
        """The agent whose steps it takes."""

    def send(self, order: Order) -> Answer:
        """Hand an order over, without waiting for the robot."""

    def poll(self, timeout_s: float = 0.0) -> Report | None:
        """Return the next report, after waiting for one if need be; None if none came in time."""

    def cancel(self) -> None:
        """Ask the robot to give its open order up; nothing if none is open."""

    def state(self) -> RobotState:
        """Tell where the robot stands."""

    def close(self) -> None:
        """Let go of connections and threads."""


class OrderBook:
    """The orders of one robot: which is open, which numbers are used. For adapters.

    Examples
    --------
    >>> book = OrderBook()
    >>> book.open(Order(1, ("wait", "r1")))
    Accepted(number=1)
    >>> book.open(Order(2, ("wait", "r1")))
    Refused(number=2, reason='order 1 is still open')
    >>> book.answer(1), book.answer(1)
    (True, False)
    """

    def __init__(self) -> None:
        self.order: Order | None = None
        self.last_number = 0

    def refusal(self, order: Order) -> Refused | None:
        """Say why an order can't be opened now, if it can't."""
        if self.order is not None:
            return Refused(order.number, f"order {self.order.number} is still open")
        if order.number <= self.last_number:
            return Refused(order.number, f"numbers must rise; {self.last_number} has been used")
        return None

    def open(self, order: Order) -> Answer:
        """Note an order as open, unless it must be refused."""
        refusal = self.refusal(order)
        if refusal is not None:
            return refusal
        self.order, self.last_number = order, order.number
        return Accepted(order.number)

    def answer(self, number: int) -> bool:
        """Note an order as answered; False if it was not open."""
        if self.order is None or self.order.number != number:
            return False
        self.order = None
        return True


def facts_of(report: Report) -> tuple[Fact, ...]:
    """Return what a report says is so.

    Examples
    --------
    >>> facts_of(Failed(1, "battery"))
    ()
    """
    return () if isinstance(report, Failed) else report.facts

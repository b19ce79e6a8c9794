"""A robot whose steps all succeed at once: for games in which only the plan and the person matter."""

from explicable.execution.robots.protocol import (
    Accepted,
    Answer,
    Finished,
    Order,
    Refused,
    Report,
    RobotState,
)


class FaultlessRobot:
    """A robot without a world: whatever it is sent is done.

    Examples
    --------
    >>> robot = FaultlessRobot("r1")
    >>> robot.send(Order(1, ("wait", "r1"))), robot.poll()
    (Accepted(number=1), Finished(number=1, facts=()))
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self._order: Order | None = None

    def send(self, order: Order) -> Answer:
        """Take an order, unless one is open."""
        if self._order is not None:
            return Refused(order.number, f"order {self._order.number} is still open")
        self._order = order
        return Accepted(order.number)

    def poll(self, timeout_s: float = 0.0) -> Report | None:  # noqa: ARG002 (nothing to wait for)
        """Finish the open order."""
        if self._order is None:
            return None
        number, self._order = self._order.number, None
        return Finished(number)

    def cancel(self) -> None:
        """Too late: the order is as good as done."""

    def state(self) -> RobotState:
        """Tell which order is open."""
        return RobotState(connected=True, order=self._order)

    def close(self) -> None:
        """Forget the open order."""
        self._order = None

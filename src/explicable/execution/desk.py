"""Where a planner works: while the game waits, or in the background while the robot keeps moving."""

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures import TimeoutError as LateError
from typing import Protocol

from explicable.errors import ResourceError
from explicable.execution.plans import Planner, Proposal, Situation
from explicable.search import Outcome


class Desk(Protocol):
    """A planner at work for a game.

    Attributes
    ----------
    planning_s
        How long each plan took, in seconds, whether it was wanted in the end or not.
    """

    planning_s: list[float]

    def request(self, situation: Situation) -> None:
        """Ask for a plan."""

    def poll(self, timeout_s: float) -> Proposal | None:
        """Return the plan that was asked for last, after waiting for it if need be; None if it is late."""

    def cancel(self) -> None:
        """Want the plan no more."""

    def close(self) -> None:
        """End the work."""


class OpenDesk:
    """The game waits for each plan: the same game every time."""

    def __init__(self, planner: Planner, clock: Callable[[], float] = time.perf_counter) -> None:
        self._planner, self._clock = planner, clock
        self._situation: Situation | None = None
        self.planning_s: list[float] = []

    def request(self, situation: Situation) -> None:
        """Ask for a plan."""
        self._situation = situation

    def poll(self, timeout_s: float) -> Proposal | None:  # noqa: ARG002 (a plan is never late here)
        """Make the plan that was asked for last."""
        if self._situation is None:
            return None
        began = self._clock()
        proposal = propose(self._planner, self._situation)
        self.planning_s.append(self._clock() - began)
        self._situation = None
        return proposal

    def cancel(self) -> None:
        """Want the plan no more."""
        self._situation = None

    def close(self) -> None:
        """Nothing is left to end."""


class BackDesk:
    """One thread plans; a plan that is no longer wanted is finished and thrown away."""

    def __init__(self, planner: Planner, clock: Callable[[], float] = time.perf_counter) -> None:
        self._planner, self._clock = planner, clock
        self._thread = ThreadPoolExecutor(1, "planner")
        self._plan: Future[Proposal] | None = None
        self.planning_s: list[float] = []

    def request(self, situation: Situation) -> None:
        """Ask for a plan."""
        self._plan = self._thread.submit(self._work, situation)

    def poll(self, timeout_s: float) -> Proposal | None:
        """Return the plan that was asked for last, after waiting for it if need be; None if it is late."""
        if self._plan is None:
            return None
        try:
            proposal = self._plan.result(timeout_s)
        except LateError:
            return None
        self._plan = None
        return proposal

    def cancel(self) -> None:
        """Want the plan no more; if it has not been begun, it won't be."""
        if self._plan is not None:
            self._plan.cancel()
            self._plan = None

    def close(self) -> None:
        """End the work, without waiting for what nobody wants."""
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _work(self, situation: Situation) -> Proposal:
        began = self._clock()
        proposal = propose(self._planner, situation)
        self.planning_s.append(self._clock() - began)
        return proposal


def propose(planner: Planner, situation: Situation) -> Proposal:
    """Ask a planner; that it ran out of memory is an answer like another."""
    try:
        return planner(situation)
    except ResourceError:
        return Proposal(Outcome.LIMIT)

"""Checks that an adapter keeps the protocol; for adapters of other makers too, and for any test runner.

An adapter is checked on a *rig*: the adapter, connected to a far end that was told beforehand how to answer
which step. Each check gets a fresh rig::

    @contextmanager
    def rig():
        far_end = ...  # answers the steps as the Rig below says
        yield Rig(MyRobot(...), finishes=(...), fails=..., blocks=..., hangs=...)


    assert check(rig) == ()
"""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

from explicable.errors import ExplicableError
from explicable.execution.robots.protocol import (
    Accepted,
    Blocked,
    Failed,
    Finished,
    Observation,
    Order,
    Refused,
    Report,
    Robot,
)
from explicable.model.problem import GroundAtom

_CANCEL_GRACE_S = 0.2


@dataclass(frozen=True, slots=True)
class Rig:
    """An adapter on the bench.

    Parameters
    ----------
    robot
        A fresh adapter; nothing has been sent.
    finishes
        Two steps or more that the far end will finish, in this order.
    fails, blocks
        A step that it will fail, and one of which it will say that it is blocked.
    hangs
        A step that it will be about until it is cancelled.
    patience_s
        How long an answer may take, in seconds.
    """

    robot: Robot
    finishes: tuple[GroundAtom, ...]
    fails: GroundAtom
    blocks: GroundAtom
    hangs: GroundAtom
    patience_s: float = 10.0

    def answer(self) -> Report | None:
        """Wait for the next report that is no mere observation."""
        report = self.robot.poll(self.patience_s)
        while isinstance(report, Observation):
            report = self.robot.poll(self.patience_s)
        return report


class ConformanceError(ExplicableError):
    """An adapter breaks a rule of the protocol."""


MakeRig = Callable[[], AbstractContextManager[Rig]]
Check = Callable[[Rig], None]


def check(make_rig: MakeRig) -> tuple[str, ...]:
    """Run every check, each on a fresh rig.

    Returns
    -------
    tuple of str
        What is wrong, one line for each check that found something.
    """
    wrong = []
    for run in CHECKS:
        with make_rig() as rig:
            try:
                run(rig)
            except ConformanceError as error:
                wrong.append(f"{run.__name__}: {error}")
            finally:
                rig.robot.close()
    return tuple(wrong)


def idle_at_first(rig: Rig) -> None:
    """Find a fresh robot connected, without an order, and cancelling harmless."""
    state = rig.robot.state()
    _require(state.connected, "a fresh robot must be connected")
    _require(state.order is None, f"a fresh robot has {state.order}")
    rig.robot.cancel()
    report = rig.robot.poll()
    _require(report is None or isinstance(report, Observation), f"without an order it reports {report}")


def finishes_in_order(rig: Rig) -> None:
    """See each step accepted and answered by one `Finished`; numbers may leave gaps."""
    for place, action in enumerate(rig.finishes):
        order = Order(3 * place + 1, action)
        _accept(rig, order)
        _expect(rig, Finished, order.number)
        _require(rig.robot.state().order is None, "an answered order must not stay open")
    report = rig.robot.poll()
    _require(report is None or isinstance(report, Observation), f"after the last answer it reports {report}")


def fails(rig: Rig) -> None:
    """See a step answered by `Failed`, and the next accepted."""
    _accept(rig, Order(1, rig.fails))
    _expect(rig, Failed, 1)
    _accept(rig, Order(2, rig.finishes[0]))
    _expect(rig, Finished, 2)


def is_blocked(rig: Rig) -> None:
    """See a step answered by `Blocked`, with a fact."""
    _accept(rig, Order(1, rig.blocks))
    report = _expect(rig, Blocked, 1)
    _require(isinstance(report, Blocked) and bool(report.facts), "it must say which fact is in the way")


def is_busy(rig: Rig) -> None:
    """See an order refused while another is open, which stays open."""
    order = Order(1, rig.hangs)
    _accept(rig, order)
    _require(rig.robot.state().order == order, "the order under way must show in the state")
    answer = rig.robot.send(Order(2, rig.finishes[0]))
    _require(isinstance(answer, Refused), f"a second order while one is open: {answer}")
    _require(rig.robot.state().order == order, "a refused order must not take the open one's place")


def refuses_used_numbers(rig: Rig) -> None:
    """See a number refused that has been used, or a lower one."""
    _accept(rig, Order(5, rig.finishes[0]))
    _expect(rig, Finished, 5)
    for number in (5, 4):
        answer = rig.robot.send(Order(number, rig.finishes[1]))
        _require(isinstance(answer, Refused), f"order {number} after order 5: {answer}")
    _accept(rig, Order(6, rig.finishes[1]))
    _expect(rig, Finished, 6)


def waits_no_longer_than_told(rig: Rig) -> None:
    """See polling return None while nothing happens."""
    _accept(rig, Order(1, rig.hangs))
    for timeout_s in (0.0, 0.05):
        report = rig.robot.poll(timeout_s)
        _require(report is None or isinstance(report, Observation), f"nothing has happened but {report}")


def cancels(rig: Rig) -> None:
    """See a cancelled order answered by one `Failed`, however often it is cancelled."""
    _accept(rig, Order(1, rig.hangs))
    rig.robot.poll(_CANCEL_GRACE_S)
    rig.robot.cancel()
    rig.robot.cancel()
    _expect(rig, Failed, 1)
    _accept(rig, Order(2, rig.finishes[0]))
    _expect(rig, Finished, 2)


def cancels_at_once(rig: Rig) -> None:
    """See an order answered that is cancelled before the robot has looked at it."""
    _accept(rig, Order(1, rig.hangs))
    rig.robot.cancel()
    _expect(rig, Failed, 1)


def closes(rig: Rig) -> None:
    """See a closed robot refuse and be silent; closing twice is harmless."""
    _accept(rig, Order(1, rig.hangs))
    rig.robot.close()
    rig.robot.close()
    _require(isinstance(rig.robot.send(Order(2, rig.finishes[0])), Refused), "a closed robot must refuse")
    _require(rig.robot.poll() is None, "a closed robot must be silent")
    _require(not rig.robot.state().connected, "a closed robot is not connected")
    rig.robot.cancel()


CHECKS: tuple[Check, ...] = (
    idle_at_first,
    finishes_in_order,
    fails,
    is_blocked,
    is_busy,
    refuses_used_numbers,
    waits_no_longer_than_told,
    cancels,
    cancels_at_once,
    closes,
)


def _accept(rig: Rig, order: Order) -> None:
    answer = rig.robot.send(order)
    _require(answer == Accepted(order.number), f"{order} should be accepted: {answer}")


def _expect(rig: Rig, kind: type[Report], number: int) -> Report:
    report = rig.answer()
    expected = f"order {number} should be answered by {kind.__name__}: {report}"
    if not isinstance(report, kind) or isinstance(report, Observation) or report.number != number:
        raise ConformanceError(expected)
    return report


def _require(holds: bool, message: str) -> None:
    if not holds:
        raise ConformanceError(message)

"""The door through which robots' reports come in: what can't be is turned away and noted."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from explicable.execution.robots.protocol import (
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
from explicable.model.problem import Problem, supertypes
from explicable.model.task import Task

_MAX_OBJECTIONS = 1000


@dataclass(frozen=True, slots=True)
class Objection:
    """A report, and why it was not taken as it was."""

    report: Report
    reason: str


class Door:
    """A robot whose reports have been checked against the model; itself a `Robot`.

    - An answer to an order that is not open (a duplicate, one too late, one that nobody sent) is dropped.
    - Of a report with a fact that can't be (an unknown predicate or object, an atom both true and false, two
      facts that exclude each other, such as a robot in two places) all facts are left out. The order counts
      as answered all the same; a `Blocked` without facts is a `Failed`, such an `Observation` is dropped.

    Whether a fact fits the *present* state is not for the door to say: that it doesn't is news.

    Parameters
    ----------
    robot
        The adapter.
    task
        The task it works on, for the words and for what excludes what.

    Attributes
    ----------
    objections
        What was turned away, the latest thousand.
    """

    def __init__(self, robot: Robot, task: Task) -> None:
        self._robot = robot
        self._task = task
        self._book = OrderBook()
        self.objections: deque[Objection] = deque(maxlen=_MAX_OBJECTIONS)

    @property
    def name(self) -> str:
        """The agent whose steps it takes."""
        return self._robot.name

    def send(self, order: Order) -> Answer:
        """Hand an order over, if it is a step of the task."""
        if not self._task.operators_of(order.action):
            return Refused(order.number, f"({' '.join(order.action)}) is no step of this task")
        refusal = self._book.refusal(order)
        if refusal is not None:
            return refusal
        answer = self._robot.send(order)
        if not isinstance(answer, Refused):
            self._book.open(order)
        return answer

    def poll(self, timeout_s: float = 0.0) -> Report | None:
        """Return the next report that stands; a report that falls counts as none in time."""
        report = self._robot.poll(timeout_s)
        return None if report is None else self._admit(report)

    def cancel(self) -> None:
        """Ask the robot to give its open order up."""
        self._robot.cancel()

    def state(self) -> RobotState:
        """Tell where the robot stands, with the order that is open by the door's own book."""
        return RobotState(self._robot.state().connected, self._book.order)

    def close(self) -> None:
        """Let go of connections and threads."""
        self._robot.close()

    def _admit(self, report: Report) -> Report | None:
        if not isinstance(report, Observation) and not self._book.answer(report.number):
            self.objections.append(Objection(report, f"order {report.number} is not open"))
            return None
        reason = find_objection(facts_of(report), self._task)
        if reason is None and isinstance(report, Blocked) and not report.facts:
            reason = "a blocked step needs a fact that blocks it"
        if reason is None:
            return report
        self.objections.append(Objection(report, reason))
        if isinstance(report, Finished):
            return Finished(report.number)
        return Failed(report.number, reason) if isinstance(report, Blocked) else None


def find_objection(facts: Sequence[Fact], task: Task) -> str | None:
    """Say why facts can't be so in any state of a task; None if they can.

    Constants may change: that a way is blocked after all is what robots are there to find out.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground
    >>> task = ground(encode(World(("@.*",))).composite)
    >>> find_objection([Fact(("clear", "c-0-1"), true=False)], task)
    >>> find_objection([Fact(("at", "r1", "c-0-0")), Fact(("at", "r1", "c-0-1"))], task)
    '(at r1 c-0-0) and (at r1 c-0-1) exclude each other'
    >>> find_objection([Fact(("at", "r1", "moon"))], task)
    '(at r1 moon) names an unknown object, moon'
    """
    values: dict[tuple[str, ...], bool] = {}
    holders: dict[int, Fact] = {}
    for fact in facts:
        reason = _misnaming(fact, task.problem)
        if reason is not None:
            return f"({' '.join(fact.atom)}) {reason}"
        if values.setdefault(fact.atom, fact.true) != fact.true:
            return f"({' '.join(fact.atom)}) can't be both true and false"
        number = task.fact_number(fact.atom)
        if fact.true and number is not None:
            other = holders.setdefault(task.core.fact_variable(number), fact)
            if other.atom != fact.atom:
                return f"{other} and {fact} exclude each other"
    return None


def _misnaming(fact: Fact, problem: Problem) -> str | None:
    predicates = {predicate.name: predicate for predicate in problem.domain.predicates}
    predicate = predicates.get(fact.atom[0]) if fact.atom else None
    if predicate is None:
        return "has no known predicate"
    if len(fact.atom) - 1 != len(predicate.parameters):
        return f"has {len(fact.atom) - 1} arguments instead of {len(predicate.parameters)}"
    objects = {**problem.domain.constants, **problem.objects}
    for name, parameter in zip(fact.atom[1:], predicate.parameters, strict=True):
        if name not in objects:
            return f"names an unknown object, {name}"
        if supertypes(problem.domain, objects[name]).isdisjoint(parameter.types):
            return f"has {name} where {' or '.join(parameter.types)} belongs"
    return None

"""How far the carrying out of a schedule has come: what is done, what is under way, and what may begin."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from explicable.execution.robots.protocol import Order
from explicable.model.plan import Step
from explicable.model.problem import GroundAtom
from explicable.model.schedule import Schedule


@dataclass(slots=True)
class Sent:
    """A step that was sent.

    Parameters
    ----------
    schedule, number
        Of which schedule it is, and its number there.
    order
        What its agent was told.
    time_s
        When.
    is_cancelled
        Whether its agent was asked to give it up.
    """

    schedule: Schedule
    number: int
    order: Order
    time_s: float
    is_cancelled: bool = False

    @property
    def step(self) -> Step:
        """Who was to do what."""
        return self.schedule.steps[self.number].step


class Progress:
    """How far the carrying out of a schedule has come; steps go by their numbers in it.

    Attributes
    ----------
    done
        What is done.
    under_way
        What was sent, and has not ended.
    failures
        How often a step has failed.

    Examples
    --------
    >>> from explicable.model.schedule import ScheduledStep
    >>> lift, carry = Step("r1", ("lift", "r1")), Step("r1", ("carry", "r1"))
    >>> progress = Progress(Schedule((ScheduledStep(lift, 0, 1, ()), ScheduledStep(carry, 1, 1, (0,))), 2))
    >>> [number for number, step in progress.ready()]
    [0]
    >>> progress.count_as_done(("lift", "r1"))
    >>> [number for number, step in progress.ready()], progress.rest
    ([1], (('carry', 'r1'),))
    """

    def __init__(self, schedule: Schedule) -> None:
        self.schedule = schedule
        self.done: set[int] = set()
        self.under_way: dict[int, Sent] = {}
        self.failures: Counter[int] = Counter()

    def ready(self) -> Iterator[tuple[int, Step]]:
        """Yield the steps that can be sent once their agents are free: all those before them are done."""
        for number, scheduled in enumerate(self.schedule.steps):
            if self._is_to_come(number) and self.done.issuperset(scheduled.after):
                yield number, scheduled.step

    @property
    def rest(self) -> tuple[GroundAtom, ...]:
        """What is not done, in order."""
        steps = enumerate(self.schedule.steps)
        return tuple(scheduled.step.action for number, scheduled in steps if number not in self.done)

    @property
    def busy(self) -> set[str]:
        """Agents of whom a step is under way."""
        return {sent.step.agent for sent in self.under_way.values()}

    def sent_to(self, agent: str) -> Sent | None:
        """Return what an agent has under way."""
        return next((sent for sent in self.under_way.values() if sent.step.agent == agent), None)

    def count_as_done(self, action: GroundAtom) -> None:
        """Take the first step to come with this action for done: somebody has done it unasked."""
        steps = enumerate(self.schedule.steps)
        for number, scheduled in steps:
            if scheduled.step.action == action and self._is_to_come(number):
                self.done.add(number)
                return

    def _is_to_come(self, number: int) -> bool:
        return number not in self.done and number not in self.under_way

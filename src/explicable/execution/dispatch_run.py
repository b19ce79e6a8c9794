"""What a dispatcher is told about waiting, and what it tells about how a schedule was carried out."""

import math
from dataclasses import dataclass

from explicable.execution.episodes import Ending
from explicable.execution.robots.protocol import Report
from explicable.execution.runs import Run
from explicable.model.plan import Step


@dataclass(frozen=True, slots=True)
class DispatchLimits:
    """How long the dispatcher waits for what.

    Parameters
    ----------
    step_s
        Seconds after which an agent is asked to give its step up; after as long again it is lost.
    total_s
        Seconds for everything.
    attempts
        How often a step is tried before its failing is put down to a fact.
    max_plans
        How often the rest is planned anew.
    """

    step_s: float = 60.0
    total_s: float = math.inf
    attempts: int = 3
    max_plans: int = 100


@dataclass(frozen=True, slots=True)
class Dispatched:
    """A step that was sent, and how it ended.

    Parameters
    ----------
    step
        Who did what; a step that nobody had sent, of a person's own accord, starts when it ends.
    start_s, end_s
        Seconds since the beginning.
    report
        The answer; None if none came, or nobody had asked.
    """

    step: Step
    start_s: float
    end_s: float
    report: Report | None


@dataclass(frozen=True, slots=True)
class DispatchRun:
    """A schedule carried out.

    Parameters
    ----------
    ending
        How it ended.
    steps
        In the order in which they ended.
    num_plans
        How often the rest was planned anew.
    lost
        Agents that did not answer any more.
    played
        All that happened, to be put on record (`explicable.execution.record`).
    """

    ending: Ending
    steps: tuple[Dispatched, ...]
    num_plans: int
    lost: frozenset[str]
    played: Run

    @property
    def makespan_s(self) -> float:
        """When the last step was done, in seconds since the beginning."""
        return max((done.end_s for done in self.steps), default=0.0)

"""What a search hands back."""

from dataclasses import dataclass
from enum import StrEnum


class Outcome(StrEnum):
    """How a search ended."""

    SOLVED = "solved"
    UNSOLVABLE = "unsolvable"
    """Proved: the whole search space was looked at, leaving out only states that provably lead nowhere."""
    LIMIT = "limit reached"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, slots=True)
class SearchResult:
    """A plan, or why there is none.

    Attributes
    ----------
    outcome
        ``SOLVED`` if there is a plan, even where a limit kept an anytime search from improving it;
        ``INTERRUPTED`` after Ctrl-C, with the best plan so far or none.
    operators
        The plan as operators of the task, or None. It has been executed on the task.
    cost
        The plan's cost, or None.
    objective
        What was minimised: the cost, or with a scorer cost + alpha * dist. None without a plan.
    lower_bound
        No plan has a lower objective; 0 if nothing better is known.
    is_optimal
        Proved: no plan is better.
    evaluations
        States for which a heuristic was computed.
    expansions
        States whose successors were made.
    memory_bytes
        Memory held by nodes and open lists at the end.
    search_s
        Wall-clock seconds in the search, set-up of heuristics included.
    limit
        Which limit was reached: ``"time"``, ``"memory"``, ``"evaluations"`` or None.
    """

    outcome: Outcome
    operators: tuple[int, ...] | None
    cost: int | None
    objective: float | None
    lower_bound: float
    is_optimal: bool
    evaluations: int
    expansions: int
    memory_bytes: int
    search_s: float
    limit: str | None

"""Heuristic search over grounded tasks."""

from explicable._core import PathScorer
from explicable.search.any_labeller import scorer_of
from explicable.search.forward import Algorithm, Closing, search
from explicable.search.interruption import held_interrupt
from explicable.search.result import Outcome, SearchResult
from explicable.search.ways import Way, find_way

__all__ = [
    "Algorithm",
    "Closing",
    "Outcome",
    "PathScorer",
    "SearchResult",
    "Way",
    "find_way",
    "held_interrupt",
    "scorer_of",
    "search",
]

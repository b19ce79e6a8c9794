"""Heuristic search over grounded tasks."""

from explicable._core import PathScorer
from explicable.search.any_labeller import scorer_of
from explicable.search.costs_to_go import CostsToGo, Goal
from explicable.search.forward import Algorithm, Closing, search
from explicable.search.interruption import held_interrupt
from explicable.search.result import Outcome, SearchResult

__all__ = [
    "Algorithm",
    "Closing",
    "CostsToGo",
    "Goal",
    "Outcome",
    "PathScorer",
    "SearchResult",
    "held_interrupt",
    "scorer_of",
    "search",
]

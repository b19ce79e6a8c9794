"""Heuristic search over grounded tasks."""

from explicable._core import PathScorer
from explicable.search.forward import Algorithm, Closing, search
from explicable.search.result import Outcome, SearchResult

__all__ = ["Algorithm", "Closing", "Outcome", "PathScorer", "SearchResult", "search"]

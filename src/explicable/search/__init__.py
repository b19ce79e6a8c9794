"""Heuristic search over grounded tasks."""

from explicable.search.forward import search
from explicable.search.result import Outcome, SearchResult

__all__ = ["Outcome", "SearchResult", "search"]

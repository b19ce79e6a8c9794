"""Heuristic search over grounded tasks."""

"""Working together with a person."""

from explicable.execution.episodes import Ending, Episode, assign, judge, simulate, simulate_study
from explicable.execution.participants import Family, Participant, builtin_families, read_families
from explicable.execution.setting import Setting, prepare

__all__ = [
    "Ending",
    "Episode",
    "Family",
    "Participant",
    "Setting",
    "assign",
    "builtin_families",
    "judge",
    "prepare",
    "read_families",
    "simulate",
    "simulate_study",
]

"""Working together with a person."""

from explicable.execution.course import Course, Notice, Occurrence
from explicable.execution.episodes import (
    Ending,
    Episode,
    Game,
    assign,
    judge,
    play,
    simulate,
    simulate_study,
)
from explicable.execution.facts import observable_facts
from explicable.execution.loop import ClosedLoop, Limits, Run, run
from explicable.execution.monitor import draw_monitor
from explicable.execution.participants import Family, Participant, builtin_families, read_families
from explicable.execution.people import Person, ScriptedPerson, SimulatedPerson
from explicable.execution.plans import Planner, Proposal, Situation, num_changes
from explicable.execution.setting import Setting, prepare

__all__ = [
    "ClosedLoop",
    "Course",
    "Ending",
    "Episode",
    "Family",
    "Game",
    "Limits",
    "Notice",
    "Occurrence",
    "Participant",
    "Person",
    "Planner",
    "Proposal",
    "Run",
    "ScriptedPerson",
    "Setting",
    "SimulatedPerson",
    "Situation",
    "assign",
    "builtin_families",
    "draw_monitor",
    "judge",
    "num_changes",
    "observable_facts",
    "play",
    "prepare",
    "read_families",
    "run",
    "simulate",
    "simulate_study",
]

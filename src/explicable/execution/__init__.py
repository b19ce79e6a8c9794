"""Working together with a person."""

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
from explicable.execution.loop import FaultlessRobot, Occurrence, Planner, Proposal, Robot, Run, run
from explicable.execution.monitor import draw_monitor
from explicable.execution.participants import Family, Participant, builtin_families, read_families
from explicable.execution.people import Person, ScriptedPerson, SimulatedPerson
from explicable.execution.setting import Setting, prepare

__all__ = [
    "Ending",
    "Episode",
    "Family",
    "FaultlessRobot",
    "Game",
    "Occurrence",
    "Participant",
    "Person",
    "Planner",
    "Proposal",
    "Robot",
    "Run",
    "ScriptedPerson",
    "Setting",
    "SimulatedPerson",
    "assign",
    "builtin_families",
    "draw_monitor",
    "judge",
    "play",
    "prepare",
    "read_families",
    "run",
    "simulate",
    "simulate_study",
]

"""Working together with a person."""

from explicable.execution.adaptation import adapt
from explicable.execution.course import Course
from explicable.execution.episode_files import read_episode, write_episode
from explicable.execution.episodes import (
    Ending,
    Episode,
    Game,
    StudyWay,
    assign,
    judge,
    play,
    simulate,
    simulate_study,
)
from explicable.execution.facts import observable_facts
from explicable.execution.loop import ClosedLoop, run
from explicable.execution.monitor import draw_monitor
from explicable.execution.notices import Notice, Occurrence
from explicable.execution.participants import Family, Participant, builtin_families, read_families
from explicable.execution.people import Person, ScriptedPerson, SimulatedPerson
from explicable.execution.plans import Planner, Proposal, Situation, num_changes
from explicable.execution.recognition import PersonFilter, draw_evenly
from explicable.execution.records import EpisodeRecord, Replay, record, replay
from explicable.execution.runs import Limits, Run
from explicable.execution.setting import Setting, prepare
from explicable.execution.showing import show
from explicable.execution.thoughts import Thoughts

__all__ = [
    "ClosedLoop",
    "Course",
    "Ending",
    "Episode",
    "EpisodeRecord",
    "Family",
    "Game",
    "Limits",
    "Notice",
    "Occurrence",
    "Participant",
    "Person",
    "PersonFilter",
    "Planner",
    "Proposal",
    "Replay",
    "Run",
    "ScriptedPerson",
    "Setting",
    "SimulatedPerson",
    "Situation",
    "StudyWay",
    "Thoughts",
    "adapt",
    "assign",
    "builtin_families",
    "draw_evenly",
    "draw_monitor",
    "judge",
    "num_changes",
    "observable_facts",
    "play",
    "prepare",
    "read_episode",
    "read_families",
    "record",
    "replay",
    "run",
    "show",
    "simulate",
    "simulate_study",
    "write_episode",
]

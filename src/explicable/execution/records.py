"""Games on record: every event with its time, enough to replay the game exactly (docs/execution.md)."""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from explicable.execution.course import Course
from explicable.execution.monitor import FINAL, State
from explicable.execution.notices import Notice, Occurrence
from explicable.execution.runs import Run
from explicable.execution.setting import prepare
from explicable.labelling.records import Trace
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom
from explicable.model.task import State as GameState
from explicable.model.task import Task


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """One event, and what it led to.

    Parameters
    ----------
    notice
        What happened.
    time_s
        Seconds since the game began.
    state
        Of the monitor, afterwards.
    refusal
        Why it was not taken; empty if it was.
    digest
        Checksum of the atoms that were true afterwards; empty if they were the same as before.
    """

    notice: Notice
    time_s: float
    state: State
    refusal: str = ""
    digest: str = ""


@dataclass(frozen=True, slots=True)
class EpisodeRecord:
    """A game on record.

    Parameters
    ----------
    trace
        The steps with the answers; its notes say how the game ended.
    events
        All of them, in order.
    observable
        Facts that the game was prepared for.
    map_text
        Of the first-response map that was played, if it was one.
    num_deviations, num_changes, planning_s, at_once
        As in `Run`.
    """

    trace: Trace
    events: tuple[RecordedEvent, ...]
    observable: tuple[GroundAtom, ...] = ()
    map_text: str | None = None
    num_deviations: int = 0
    num_changes: int = 0
    planning_s: tuple[float, ...] = ()
    at_once: bool = False


@dataclass(frozen=True, slots=True)
class Replay:
    """A game played again from its record.

    Parameters
    ----------
    course
        What came of it.
    differences
        Where it came out otherwise than recorded; empty if it is exactly the same game.
    """

    course: Course
    differences: tuple[str, ...] = ()


def record(
    played: Run,
    task: Task,
    *,
    observable: Iterable[GroundAtom] = (),
    map_text: str | None = None,
    notes: Mapping[str, Any] | None = None,
) -> EpisodeRecord:
    """Put a game on record.

    Parameters
    ----------
    played
        The game.
    task
        Of the truth in its setting: ``setting.truth.task``.
    observable
        What the setting was prepared for.
    map_text, notes
        Of the first-response map; and whatever else JSON can hold.
    """
    trace = played.episode.trace
    return EpisodeRecord(
        replace(trace, notes={**trace.notes, **(notes or {})}),
        _digested(played.occurrences, task),
        tuple(observable),
        map_text,
        played.num_deviations,
        played.num_changes,
        played.planning_s,
        played.at_once,
    )


def _digested(occurrences: Sequence[Occurrence], task: Task) -> tuple[RecordedEvent, ...]:
    before, events = task.initial_state, []
    for it in occurrences:
        digest = "" if it.game_state == before else _digest(task, it.game_state)
        events.append(RecordedEvent(it.notice, it.time_s, it.state, it.refusal, digest))
        before = it.game_state
    return tuple(events)


def _digest(task: Task, state: GameState) -> str:
    text = "\n".join(sorted(map(format_action, task.atoms(state))))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def replay(recorded: EpisodeRecord) -> Replay:
    """Play a game again, event by event, and compare what comes of it with the record.

    Raises
    ------
    PDDLError
        If the two models of the game contradict each other.
    """
    course = Course(prepare(recorded.trace.problem, recorded.observable), at_once=recorded.at_once)
    for event in recorded.events:
        course.apply(event.notice, event.time_s)
    differences = []
    again = _digested(course.occurrences, course.truth.task)
    for number, (then, now) in enumerate(zip(recorded.events, again, strict=True), start=1):
        name = f"event {number}, {then.notice.event.value}"
        if now.state is not then.state:
            differences.append(f"{name}: then {now.state.value}, on record {then.state.value}")
        if now.refusal != then.refusal:
            differences.append(f"{name}: refused for {now.refusal!r}, on record for {then.refusal!r}")
        if now.digest != then.digest:
            differences.append(f"{name}: the facts afterwards are not those on record")
    if "ending" in recorded.trace.notes and course.monitor not in FINAL:
        differences.append("the record breaks off before the game ended")
    if tuple(course.steps) != recorded.trace.steps:
        differences.append("the steps are not those of the trace")
    if (course.num_deviations, course.num_changes) != (recorded.num_deviations, recorded.num_changes):
        differences.append("deviations and changed requests are not those on record")
    return Replay(course, tuple(differences))

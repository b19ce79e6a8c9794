"""The course of a session, as a table: no input, no output, no clock.

An event that a stage does not know raises, *and nothing has happened*; so a page that was open in two tabs,
or was sent twice, can do no harm.
"""

from enum import StrEnum
from types import MappingProxyType

from explicable.errors import ExplicableError


class Stage(StrEnum):
    """Where a participant is."""

    CONSENT = "consent"
    INSTRUCTIONS = "instructions"
    PRACTICE = "practice"
    COMPREHENSION = "comprehension"
    TASKS = "tasks"
    RATINGS = "ratings"
    DEBRIEF = "debrief"
    DECLINED = "declined"
    EXCLUDED = "excluded"
    RETURNED = "returned"


class Event(StrEnum):
    """What can happen to a session."""

    CONSENTED = "consented"
    DECLINED = "declined"
    INSTRUCTED = "instructed"
    PRACTISED = "practised"
    UNDERSTOOD = "understood"
    MISUNDERSTOOD = "misunderstood"
    GAVE_UP = "understood nothing"
    FINISHED_TASK = "finished a task"
    FINISHED_TASKS = "finished all tasks"
    RATED = "rated"
    LEFT = "left"
    TIMED_OUT = "timed out"


TABLE = MappingProxyType(
    {
        (Stage.CONSENT, Event.CONSENTED): Stage.INSTRUCTIONS,
        (Stage.CONSENT, Event.DECLINED): Stage.DECLINED,
        (Stage.INSTRUCTIONS, Event.INSTRUCTED): Stage.PRACTICE,
        (Stage.INSTRUCTIONS, Event.LEFT): Stage.RETURNED,
        (Stage.INSTRUCTIONS, Event.TIMED_OUT): Stage.RETURNED,
        (Stage.PRACTICE, Event.PRACTISED): Stage.COMPREHENSION,
        (Stage.PRACTICE, Event.LEFT): Stage.RETURNED,
        (Stage.PRACTICE, Event.TIMED_OUT): Stage.RETURNED,
        (Stage.COMPREHENSION, Event.UNDERSTOOD): Stage.TASKS,
        (Stage.COMPREHENSION, Event.MISUNDERSTOOD): Stage.INSTRUCTIONS,
        (Stage.COMPREHENSION, Event.GAVE_UP): Stage.EXCLUDED,
        (Stage.COMPREHENSION, Event.LEFT): Stage.RETURNED,
        (Stage.COMPREHENSION, Event.TIMED_OUT): Stage.RETURNED,
        (Stage.TASKS, Event.FINISHED_TASK): Stage.TASKS,
        (Stage.TASKS, Event.FINISHED_TASKS): Stage.RATINGS,
        (Stage.TASKS, Event.LEFT): Stage.RETURNED,
        (Stage.TASKS, Event.TIMED_OUT): Stage.RETURNED,
        (Stage.RATINGS, Event.RATED): Stage.DEBRIEF,
        (Stage.RATINGS, Event.LEFT): Stage.RETURNED,
        (Stage.RATINGS, Event.TIMED_OUT): Stage.RETURNED,
    }
)
"""The stage that follows, by stage and event."""

PARTS = (Stage.INSTRUCTIONS, Stage.PRACTICE, Stage.COMPREHENSION, Stage.TASKS, Stage.RATINGS, Stage.DEBRIEF)
"""The stages of a session that gets to the end, in order."""

FINAL = frozenset({Stage.DEBRIEF, Stage.DECLINED, Stage.EXCLUDED, Stage.RETURNED})
"""Stages that nothing leads out of."""

DEPARTURES = (Event.LEFT, Event.TIMED_OUT, Event.GAVE_UP)
"""Events by which a session ends before its end."""

ACTIVE = frozenset(Stage) - FINAL
"""Stages in which a session takes a place in the study."""


class ConflictError(ExplicableError):
    """What a participant sent does not fit where the session stands; nothing has changed."""


def advance(stage: Stage, event: Event) -> Stage:
    """Return the stage after an event.

    Raises
    ------
    ConflictError
        If the event cannot happen in this stage.

    Examples
    --------
    >>> advance(Stage.CONSENT, Event.CONSENTED)
    <Stage.INSTRUCTIONS: 'instructions'>
    >>> advance(Stage.DEBRIEF, Event.RATED)
    Traceback (most recent call last):
    explicable.study.protocol.ConflictError: 'rated' cannot happen in the stage 'debrief'
    """
    if (stage, event) not in TABLE:
        raise ConflictError(f"{event.value!r} cannot happen in the stage {stage.value!r}")
    return TABLE[stage, event]

"""How far a study has come: who got to which part of the session, and how often each task is done."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from explicable.study.materials import Materials
from explicable.study.protocol import DEPARTURES, PARTS
from explicable.study.records import TaskRow


@dataclass(frozen=True, slots=True)
class TaskCount:
    """How far a task has come in a condition."""

    task: str
    kind: str
    source: str
    condition: str
    wanted: int
    finished: int
    under_way: int


@dataclass(frozen=True, slots=True)
class PartCount:
    """How many have come to one part of the session, and what became of them there.

    Attributes
    ----------
    reached
        Who is there, has got further, or has ended there or later.
    there
        Who is there now.
    left, timed_out, excluded
        Who left from there, was silent there for too long, or misunderstood the instructions too often.
    """

    part: str
    reached: int
    there: int
    left: int
    timed_out: int
    excluded: int


def count_parts(stages: Mapping[str, int], departures: Mapping[tuple[str, str], int]) -> list[PartCount]:
    """Count for each part of the session who got there, and who did not get further.

    Parameters
    ----------
    stages
        Sessions by the stage in which they are.
    departures
        Who ended before the end, by the stage and the event.

    Examples
    --------
    >>> tasks = count_parts({"tasks": 2, "debrief": 3, "returned": 1}, {("tasks", "left"): 1})[3]
    >>> tasks.reached, tasks.there, tasks.left
    (6, 2, 1)
    """
    counts: list[PartCount] = []
    reached = 0
    for part in reversed(PARTS):
        there = stages.get(part, 0)
        left, timed_out, excluded = (departures.get((part, event), 0) for event in DEPARTURES)
        reached += there + left + timed_out + excluded
        counts.append(PartCount(part.value, reached, there, left, timed_out, excluded))
    return counts[::-1]


def task_counts(materials: Materials, done: Sequence[TaskRow]) -> list[TaskCount]:
    """Compare for each task, in each condition where it is played, what is done with what is wanted."""
    counts = []
    for task in materials.study.task:
        conditions = list(materials.conditions) if task.kind == "play" else [""]
        for condition in conditions:
            mine = [row for row in done if row.task == task.name and condition in {"", row.condition}]
            finished = sum(row.num for row in mine if row.status == "done")
            under_way = sum(row.num for row in mine if row.status in {"open", "started"})
            counts.append(
                TaskCount(task.name, task.kind, task.source, condition, task.people, finished, under_way)
            )
    return counts

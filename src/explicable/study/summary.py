"""What a study has come to: places, drop-out, labels, agreement and explicability, by origin.

People and simulated participants are never counted together.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from explicable.errors import UsageError
from explicable.labelling.annotators import krippendorff_alpha
from explicable.study.materials import Materials
from explicable.study.progress import PartCount, TaskCount, count_parts, task_counts
from explicable.study.records import (
    LabelRow,
    completion_codes,
    count_departures,
    count_stages,
    count_steps,
    count_tasks,
    read_checks,
    read_labels,
)
from explicable.study.transaction import Transaction

NUM_RESAMPLES = 1000


@dataclass(frozen=True, slots=True)
class SourceScore:
    """How explicable the steps of what one source made were found.

    Attributes
    ----------
    f_robot
        Share of the labelled robot steps that were called explicable, pooled.
    f_macro
        Mean of the tasks' shares.
    low, high
        Ends of the 95 % interval of ``f_robot``, from a bootstrap over participants; None for a single one.
    num_labels, num_participants, num_tasks
        What it rests on.
    """

    source: str
    f_robot: float
    f_macro: float
    low: float | None
    high: float | None
    num_labels: int
    num_participants: int
    num_tasks: int


@dataclass(frozen=True, slots=True)
class PlanScore:
    """What one task's plans cost, and how explicable they were found; of a played map, the plans that arose.

    Attributes
    ----------
    cost
        Mean number of steps of the whole team, over those who finished.
    f_robot
        Share of the labelled robot steps that were called explicable; None without labels.
    num_finished, num_labels
        What they rest on.
    """

    task: str
    source: str
    condition: str
    cost: float
    f_robot: float | None
    num_finished: int
    num_labels: int


@dataclass(frozen=True, slots=True)
class PersonQuality:
    """What one participant's answers are like: to find careless ones, and to pay the others.

    Attributes
    ----------
    code
        The completion code; None for who has not got to the end.
    median_latency_s
        Of the labels, by the participant's own clock; None where it told nothing.
    checks_right, num_checks
        Attention checks answered, and answered as they asked.
    """

    participant: str
    code: str | None
    num_labels: int
    share_explicable: float
    median_latency_s: float | None
    checks_right: int
    num_checks: int


@dataclass(frozen=True, slots=True)
class Summary:
    """What the participants of one origin have done.

    Attributes
    ----------
    stages
        Sessions by the stage in which they are.
    dropout
        For each part of the session, who got there and who did not get further.
    num_labels
        All labels, those of practice left out.
    agreement
        Krippendorff's alpha over the steps of replayed plans; None where no step has two labels.
    median_latency_s
        Of the labels, by the participants' own clocks.
    quality
        Of each participant who has labelled anything.
    """

    origin: str
    stages: dict[str, int]
    dropout: tuple[PartCount, ...]
    tasks: tuple[TaskCount, ...]
    num_labels: int
    scores: tuple[SourceScore, ...]
    plans: tuple[PlanScore, ...]
    agreement: float | None
    median_latency_s: float | None
    quality: tuple[PersonQuality, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return everything as values that JSON has."""
        return asdict(self)


def summarise(tx: Transaction, materials: Materials, origin: str) -> Summary:
    """Work out what the participants of one origin (``person`` or ``simulated``) have done."""
    labels = read_labels(tx, origin)
    by_source: dict[str, list[LabelRow]] = defaultdict(list)
    for label in labels:
        if label.task in materials.tasks:
            source = "play" if label.kind == "play" else materials.tasks[label.task].source
            by_source[source].append(label)
    rng, stages = np.random.default_rng(materials.study.seed), count_stages(tx, origin)
    return Summary(
        origin=origin,
        stages=stages,
        dropout=tuple(count_parts(stages, count_departures(tx, origin))),
        tasks=tuple(task_counts(materials, count_tasks(tx, origin))),
        num_labels=len(labels),
        scores=tuple(_score(source, rows, rng) for source, rows in sorted(by_source.items())),
        plans=tuple(_plan_scores(tx, materials, origin, labels)),
        agreement=_agreement(labels),
        median_latency_s=_median([label.latency_s for label in labels]),
        quality=tuple(_quality(tx, materials, origin, labels)),
    )


def _score(source: str, rows: Sequence[LabelRow], rng: np.random.Generator) -> SourceScore:
    people = sorted({row.participant for row in rows})
    said = np.zeros((len(people), 2))  # explicable, all
    tasks: dict[tuple[str, str], list[bool]] = defaultdict(list)
    for row in rows:
        said[people.index(row.participant)] += (row.explicable, 1)
        tasks[row.task, row.condition].append(row.explicable)
    low = high = None
    if len(people) > 1:
        drawn = said[rng.integers(len(people), size=(NUM_RESAMPLES, len(people)))].sum(axis=1)
        low, high = (float(end) for end in np.quantile(drawn[:, 0] / drawn[:, 1], (0.025, 0.975)))
    return SourceScore(
        source=source,
        f_robot=float(said[:, 0].sum() / said[:, 1].sum()),
        f_macro=float(np.mean([np.mean(labels) for labels in tasks.values()])),
        low=low,
        high=high,
        num_labels=len(rows),
        num_participants=len(people),
        num_tasks=len(tasks),
    )


def _plan_scores(
    tx: Transaction, materials: Materials, origin: str, labels: Sequence[LabelRow]
) -> Iterator[PlanScore]:
    said: dict[tuple[str, str], list[bool]] = defaultdict(list)
    for label in labels:
        said[label.task, label.condition].append(label.explicable)
    for row in count_steps(tx, origin):
        if row.task in materials.tasks:
            task, answers = materials.tasks[row.task], said[row.task, row.condition]
            yield PlanScore(
                task=row.task,
                source=task.source if task.kind == "replay" else "play",
                condition=row.condition,
                cost=row.num_steps / row.num_finished,
                f_robot=sum(answers) / len(answers) if answers else None,
                num_finished=row.num_finished,
                num_labels=len(answers),
            )


def _agreement(labels: Sequence[LabelRow]) -> float | None:
    """Return the agreement on steps that several people saw: those of replayed plans."""
    items: dict[tuple[str, str, int], dict[str, bool]] = defaultdict(dict)
    for label in labels:
        if label.kind == "replay":
            items[label.task, label.condition, label.number][label.participant] = label.explicable
    try:
        return krippendorff_alpha(list(items.values()))
    except UsageError:
        return None


def _quality(
    tx: Transaction, materials: Materials, origin: str, labels: Sequence[LabelRow]
) -> Iterator[PersonQuality]:
    by_person: dict[str, list[LabelRow]] = defaultdict(list)
    for label in labels:
        by_person[label.participant].append(label)
    wanted = {f"check-{n}": check.answer for n, check in enumerate(materials.study.check, start=1)}
    checks: dict[str, list[bool]] = defaultdict(list)
    for answer in read_checks(tx, origin):
        checks[answer.participant].append(answer.value == wanted.get(answer.name))
    codes = completion_codes(tx, origin)
    for person, rows in sorted(by_person.items()):
        yield PersonQuality(
            participant=person,
            code=codes.get(person),
            num_labels=len(rows),
            share_explicable=sum(row.explicable for row in rows) / len(rows),
            median_latency_s=_median([row.latency_s for row in rows]),
            checks_right=sum(checks[person]),
            num_checks=len(checks[person]),
        )


def _median(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else None

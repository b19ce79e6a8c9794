"""Questions to the database that go over many sessions: for summaries, pages and export."""

import json
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import sqlalchemy as sql

from explicable.study import schema as tables
from explicable.study.protocol import DEPARTURES, Stage
from explicable.study.transaction import Row, Transaction

A, E, L, N, P, S, T = (
    tables.ASSIGNMENTS,
    tables.EVENTS,
    tables.LABELS,
    tables.ANSWERS,
    tables.PARTICIPANTS,
    tables.SESSIONS,
    tables.STEPS,
)


PRIVATE = frozenset({"start_request", "request", "code"})
"""Columns that are never exported: secrets, and the code by which a platform knows its people."""


class LabelRow(NamedTuple):
    """A label with where it belongs."""

    participant: str
    condition: str
    task: str
    kind: str
    number: int
    explicable: bool
    latency_s: float | None


class TaskRow(NamedTuple):
    """How many assignments of a task have a status."""

    task: str
    condition: str
    status: str
    num: int


class CheckRow(NamedTuple):
    """An answer to an attention check, which is named by its number."""

    participant: str
    name: str
    value: str


def read_labels(tx: Transaction, origin: str) -> list[LabelRow]:
    """Return all labels of one origin, those of practice left out."""
    query = (
        sql.select(
            S.c.participant, S.c.condition, A.c.task, A.c.kind, L.c.number, L.c.explicable, L.c.latency_s
        )
        .select_from(L)
        .join(A, A.c.id == L.c.assignment)
        .join(S, S.c.id == A.c.session)
        .where(L.c.origin == origin, A.c.kind != "practice")
        .order_by(L.c.assignment, L.c.number)
    )
    return [LabelRow(*row) for row in tx.stream(query)]


def count_stages(tx: Transaction, origin: str) -> dict[str, int]:
    """Count sessions by stage."""
    return {key[0]: number for key, number in tx.count(S, "stage", origin=origin).items()}


def count_departures(tx: Transaction, origin: str) -> dict[tuple[str, str], int]:
    """Count who went before the end, by the stage and the kind of event at which they did."""
    query = sql.select(E.c.kind, E.c.data).where(E.c.origin == origin, E.c.kind.in_(DEPARTURES))
    return Counter((json.loads(row.data)["stage"], row.kind) for row in tx.stream(query))


def completion_codes(tx: Transaction, origin: str) -> dict[str, str]:
    """Return the completion codes of those who have got to the end, by participant."""
    query = sql.select(S.c.participant, S.c.code).where(S.c.origin == origin, S.c.stage == Stage.DEBRIEF)
    return {row.participant: row.code for row in tx.stream(query)}


def read_checks(tx: Transaction, origin: str) -> list[CheckRow]:
    """Return the answers to attention checks."""
    query = (
        sql.select(S.c.participant, N.c.name, N.c.value)
        .join(S, S.c.id == N.c.session)
        .where(N.c.origin == origin, N.c.stage == Stage.RATINGS, N.c.name.like("check-%"))
    )
    return [CheckRow(*row) for row in tx.stream(query)]


def count_tasks(tx: Transaction, origin: str) -> list[TaskRow]:
    """Count assignments by task, condition and status."""
    query = (
        sql.select(A.c.task, S.c.condition, A.c.status, sql.func.count())
        .select_from(A)
        .join(S, S.c.id == A.c.session)
        .where(A.c.origin == origin)
        .group_by(A.c.task, S.c.condition, A.c.status)
    )
    return [TaskRow(*row) for row in tx.stream(query)]


class StepRow(NamedTuple):
    """How many finished assignments a task has, and how many steps they have together."""

    task: str
    condition: str
    num_finished: int
    num_steps: int


def count_steps(tx: Transaction, origin: str) -> list[StepRow]:
    """Count the steps of finished assignments by task and condition, those of practice left out."""
    query = (
        sql.select(A.c.task, S.c.condition, sql.func.count(sql.distinct(A.c.id)), sql.func.count())
        .select_from(T)
        .join(A, A.c.id == T.c.assignment)
        .join(S, S.c.id == A.c.session)
        .where(A.c.origin == origin, A.c.status == "done", A.c.kind != "practice")
        .group_by(A.c.task, S.c.condition)
        .order_by(A.c.task, S.c.condition)
    )
    return [StepRow(*row) for row in tx.stream(query)]


def live_sessions(tx: Transaction, since: float, stages: list[str]) -> list[Row]:
    """Return the sessions under way with a sign of life since a moment, the latest first."""
    query = (
        sql.select(S.c.participant, S.c.origin, S.c.condition, S.c.stage, S.c.position, S.c.seen)
        .where(S.c.seen >= since, S.c.stage.in_(stages))
        .order_by(S.c.seen.desc())
        .limit(200)
    )
    return list(tx.stream(query))


def labelled_steps(tx: Transaction) -> Iterator[Row]:
    """Yield every step with its label and where it belongs: the table to analyse."""
    query = (
        sql.select(
            S.c.participant,
            S.c.origin,
            S.c.condition,
            A.c.id.label("assignment"),
            A.c.task,
            A.c.kind,
            A.c.position,
            A.c.status,
            T.c.number,
            T.c.agent,
            T.c.operator,
            L.c.explicable,
            L.c.latency_s,
            L.c.client_time,
            T.c.server_time,
            S.c.study,
            S.c.version,
            S.c.seed,
        )
        .select_from(T)
        .join(A, A.c.id == T.c.assignment)
        .join(S, S.c.id == A.c.session)
        .outerjoin(L, sql.and_(L.c.assignment == T.c.assignment, L.c.number == T.c.number))
        .order_by(T.c.assignment, T.c.number)
    )
    yield from tx.stream(query)


def whole_table(tx: Transaction, name: str) -> Iterator[Row]:
    """Yield the rows of one of the tables that may be exported."""
    table = tables.METADATA.tables[name]
    columns: list[Any] = [column for column in table.c if column.name not in PRIVATE]
    yield from tx.stream(sql.select(*columns).order_by(*table.primary_key.columns))


def erase(tx: Transaction, participant: str, now: float) -> int:
    """Erase all that a participant left, but a tombstone; return the number of rows erased."""
    sessions = [row.id for row in tx.all(S, participant=participant)]
    erased = tx.remove(tables.RECRUITS, participant=participant)
    for session in sessions:
        for assignment in tx.all(A, session=session):
            erased += tx.remove(L, assignment=assignment.id) + tx.remove(T, assignment=assignment.id)
        erased += tx.remove(A, session=session) + tx.remove(tables.ANSWERS, session=session)
        erased += tx.remove(E, session=session) + tx.remove(S, id=session)
    tx.change(P, {"id": participant}, erased=now)
    return erased


def is_known(tx: Transaction, participant: str) -> bool:
    """Tell whether there are data of a participant."""
    row = tx.find(P, id=participant)
    return row is not None and row.erased is None

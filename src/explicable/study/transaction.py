"""What is read and written within one transaction: tables in, values out, no idea of what they mean."""

from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from functools import cache
from typing import Any, NamedTuple, TypeAlias, TypeVar

import sqlalchemy as sql
from sqlalchemy import Connection, Table

from explicable.errors import ExplicableError
from explicable.study import schema as tables

T = TypeVar("T")
Row: TypeAlias = sql.Row[*tuple[Any, ...]]


class Places(NamedTuple):
    """How often a task is taken: its name, condition, kind and position in the session, and how often so."""

    task: str
    condition: str
    kind: str
    position: int
    num: int


class OutdatedError(ExplicableError):
    """A row that was to be changed is no longer as it was when the change was thought out."""


class Transaction:
    """What can be read and written within one transaction, by one job or by several in turn.

    What is added and changed waits, and is sent together, one statement for many rows: before anything is
    read, and at the end.

    Parameters
    ----------
    connection
        To the database.
    memory
        What earlier transactions remembered; see `recall`.
    """

    def __init__(self, connection: Connection, memory: MutableMapping[str, object] | None = None) -> None:
        self.remembered: dict[str, object] = {}
        self._connection = connection
        self._memory = {} if memory is None else memory
        self._waiting: list[tuple[sql.Insert | sql.Update, dict[str, object]]] = []
        self._num_sent = 0

    def attempt(self, job: "Callable[[Transaction], T]") -> T:
        """Run a job of which nothing is left if it fails.

        Raises
        ------
        ExplicableError
            What the job raised; an `OutdatedError` if the whole transaction has to be given up for it.
        """
        start = self._num_sent + len(self._waiting)
        try:
            return job(self)
        except ExplicableError as error:
            if self._num_sent > start:
                raise OutdatedError("some of what the job wrote has been sent") from error
            del self._waiting[start - self._num_sent :]
            raise

    def recall(self, key: str) -> object:
        """Return what was last remembered of something, or None; whoever needs it again remembers it anew.

        It may be out of date: what follows from it has to be written by `change` with a key that tells.
        """
        known = self._memory.pop(key, None)
        return self.remembered.pop(key, known)

    def remember(self, key: str, value: object) -> None:
        """Remember something for later transactions, once this one is committed."""
        self.remembered[key] = value

    def send(self) -> None:
        """Send what waits.

        Raises
        ------
        OutdatedError
            If a row to be changed is not there.
        """
        batches: dict[sql.Insert | sql.Update, list[dict[str, object]]] = {}
        for statement, values in self._waiting:
            batches.setdefault(statement, []).append(values)
        self._num_sent += len(self._waiting)
        self._waiting.clear()
        for statement in sorted(batches, key=_rank):
            rows = batches[statement]
            num_done = self._connection.execute(statement, rows).rowcount
            if statement.is_update and num_done != len(rows):
                raise OutdatedError("what was to be changed has changed meanwhile")

    def add(self, table: Table, **values: object) -> None:
        """Insert a row."""
        self._waiting.append((_insert(table, tuple(values)), values))

    def change(self, table: Table, key: Mapping[str, object], **values: object) -> None:
        """Update the one row with the key's values; that it is not there is found out when it is sent."""
        statement = _update(table, tuple(key), tuple(values))
        self._waiting.append((statement, {**values, **_named(key)}))

    def remove(self, table: Table, **key: object) -> int:
        """Delete the rows with the key's values; return how many there were."""
        statement = sql.delete(table).where(*_equal(table, tuple(key)))
        return int(self._execute(statement, _named(key)).rowcount)

    def find(self, table: Table, **key: object) -> Row | None:
        """Return the row with the key's values, if there is one."""
        return self._execute(_select(table, tuple(key), ()), _named(key)).first()

    def all(self, table: Table, *order: str, **key: object) -> Sequence[Row]:
        """Return all rows with the key's values, ordered by the columns named."""
        return self._execute(_select(table, tuple(key), order), _named(key)).all()

    def lock_session(self, session: str, request: str) -> Row | None:
        """Return a session's row, which nobody else changes until the end of the transaction.

        Its column ``is_repeated`` says whether the request is known already.
        """
        return self._execute(_LOCKED_SESSION, {"key": session, "request_id": request}).first()

    def lock_places(self) -> None:
        """Let nobody else assign tasks until the end of the transaction."""
        if self._connection.dialect.name == "postgresql":
            self._execute(sql.text("SELECT pg_advisory_xact_lock(20001)"))

    def labelled_steps(self, assignment: int) -> Sequence[Row]:
        """Return the steps of an assignment in order, each with its label or None."""
        return self._execute(_LABELLED_STEPS, {"assignment": assignment}).all()

    def places(self, origin: str) -> list[Places]:
        """Return the places taken by people, or by simulated participants: neither takes the other's.

        They are the tasks of sessions that are under way or have finished them.
        """
        by = (
            tables.ASSIGNMENTS.c.task,
            tables.SESSIONS.c.condition,
            tables.ASSIGNMENTS.c.kind,
            tables.ASSIGNMENTS.c.position,
        )
        query = (
            sql.select(*by, sql.func.count())
            .select_from(tables.ASSIGNMENTS)
            .join(tables.SESSIONS)
            .where(
                tables.ASSIGNMENTS.c.origin == origin,
                tables.ASSIGNMENTS.c.status != "freed",
                tables.ASSIGNMENTS.c.kind != "practice",
            )
            .group_by(*by)
            .order_by(*by)
        )
        return [Places(*row) for row in self._execute(query)]

    def count(self, table: Table, *columns: str, **key: object) -> dict[tuple[Any, ...], int]:
        """Count rows by the values of some columns."""
        by = [table.c[name] for name in columns]
        query = sql.select(*by, sql.func.count()).select_from(table)
        query = query.where(*_equal(table, tuple(key))).group_by(*by)
        return {tuple(row[:-1]): row[-1] for row in self._execute(query, _named(key))}

    def silent_since(self, moment: float, stages: Sequence[str]) -> list[str]:
        """Return the sessions in one of the stages without a sign of life since a moment."""
        sessions = tables.SESSIONS
        query = sql.select(sessions.c.id).where(sessions.c.seen < moment, sessions.c.stage.in_(stages))
        return list(self._execute(query).scalars())

    def changed_since(self, moment: float) -> list[tuple[str, int]]:
        """Return the sessions, with their revisions, that were seen since a moment."""
        sessions = tables.SESSIONS
        query = sql.select(sessions.c.id, sessions.c.revision).where(sessions.c.seen >= moment)
        return [(row[0], row[1]) for row in self._execute(query)]

    def is_alive(self) -> bool:
        """Tell whether the database answers."""
        return bool(self._execute(sql.text("SELECT 1")).scalar() == 1)

    def stream(self, query: sql.Select[Any]) -> Iterator[Row]:
        """Yield a query's rows without holding them all."""
        self.send()
        yield from self._connection.execution_options(yield_per=1000).execute(query)

    def _execute(
        self, statement: sql.Executable, values: Mapping[str, object] | None = None
    ) -> sql.CursorResult[*tuple[Any, ...]]:
        self.send()
        return self._connection.execute(statement, values)


# Statements are made once for each table and its columns: to make one takes longer than to run it.


@cache
def _insert(table: Table, names: tuple[str, ...]) -> sql.Insert:
    return table.insert().values({name: sql.bindparam(name) for name in names})


@cache
def _update(table: Table, key: tuple[str, ...], values: tuple[str, ...]) -> sql.Update:
    changes: dict[str, Any] = {name: sql.bindparam(name) for name in values}
    return sql.update(table).where(*_equal(table, key)).values(**changes)


@cache
def _select(table: Table, key: tuple[str, ...], order: tuple[str, ...]) -> sql.Select[Any]:
    return sql.select(table).where(*_equal(table, key)).order_by(*(table.c[name] for name in order))


def _equal(table: Table, key: tuple[str, ...]) -> list[sql.ColumnElement[bool]]:
    return [table.c[name] == sql.bindparam(f"key_{name}") for name in key]


_ORDER = {table: number for number, table in enumerate(tables.METADATA.sorted_tables)}


def _rank(statement: sql.Insert | sql.Update) -> tuple[bool, int]:
    """Order statements: rows that others refer to come first."""
    return statement.is_update, _ORDER[statement.table]  # type: ignore[index]  # all are tables of ours


def _named(key: Mapping[str, object]) -> dict[str, object]:
    return {f"key_{name}": value for name, value in key.items()}


_LOCKED_SESSION = (
    sql.select(
        tables.SESSIONS,
        sql.exists()
        .where(
            tables.EVENTS.c.session == sql.bindparam("key"),
            tables.EVENTS.c.request == sql.bindparam("request_id"),
        )
        .label("is_repeated"),
    )
    .where(tables.SESSIONS.c.id == sql.bindparam("key"))
    .with_for_update(of=tables.SESSIONS)
)
_LABELLED_STEPS = (
    sql.select(
        tables.STEPS.c.agent, tables.STEPS.c.operator, tables.LABELS.c.explicable, tables.STEPS.c.server_time
    )
    .outerjoin(
        tables.LABELS,
        sql.and_(
            tables.LABELS.c.assignment == tables.STEPS.c.assignment,
            tables.LABELS.c.number == tables.STEPS.c.number,
        ),
    )
    .where(tables.STEPS.c.assignment == sql.bindparam("assignment"))
    .order_by(tables.STEPS.c.number)
)

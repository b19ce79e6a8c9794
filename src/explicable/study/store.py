"""The only place that touches the database: tables in, values out, and no idea of what they mean."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeVar

import sqlalchemy as sql
from sqlalchemy import Connection, Engine, Table, event
from sqlalchemy.exc import OperationalError, SQLAlchemyError

from explicable.errors import InputError
from explicable.study import schema as tables
from explicable.study.writer import UnavailableError, Writer

if TYPE_CHECKING:
    from concurrent.futures import Future

T = TypeVar("T")
Row: TypeAlias = sql.Row[*tuple[Any, ...]]

DATABASE = "study.db"


class Place(NamedTuple):
    """How often a task is taken: its name, condition, kind and position in the session."""

    task: str
    condition: str
    kind: str
    position: int


class Transaction:
    """What can be read and written within one transaction."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def add(self, table: Table, **values: object) -> None:
        """Insert a row."""
        self._connection.execute(_insert(table), values)

    def change(self, table: Table, key: Mapping[str, object], **values: object) -> int:
        """Update the rows with the key's values; return how many there were."""
        statement = _update(table, tuple(key), tuple(values))
        return int(self._connection.execute(statement, {**values, **_named(key)}).rowcount)

    def remove(self, table: Table, **key: object) -> int:
        """Delete the rows with the key's values; return how many there were."""
        statement = sql.delete(table).where(*_equal(table, tuple(key)))
        return int(self._connection.execute(statement, _named(key)).rowcount)

    def find(self, table: Table, **key: object) -> Row | None:
        """Return the row with the key's values, if there is one."""
        return self._connection.execute(_select(table, tuple(key), ()), _named(key)).first()

    def all(self, table: Table, *order: str, **key: object) -> Sequence[Row]:
        """Return all rows with the key's values, ordered by the columns named."""
        return self._connection.execute(_select(table, tuple(key), order), _named(key)).all()

    def lock_session(self, session: str, request: str) -> Row | None:
        """Return a session's row, which nobody else changes until the end of the transaction.

        Its column ``is_repeated`` says whether the request is known already.
        """
        return self._connection.execute(_LOCKED_SESSION, {"key": session, "request_id": request}).first()

    def lock_places(self) -> None:
        """Let nobody else assign tasks until the end of the transaction."""
        if self._connection.dialect.name == "postgresql":
            self._connection.execute(sql.text("SELECT pg_advisory_xact_lock(20001)"))

    def labelled_steps(self, assignment: int) -> Sequence[Row]:
        """Return the steps of an assignment in order, each with its label or None."""
        return self._connection.execute(_LABELLED_STEPS, {"assignment": assignment}).all()

    def places(self, origin: str) -> list[Place]:
        """Return the places taken by people, or by simulated participants: neither takes the other's.

        They are the tasks of sessions that are under way or have finished them.
        """
        query = (
            sql.select(
                tables.ASSIGNMENTS.c.task,
                tables.SESSIONS.c.condition,
                tables.ASSIGNMENTS.c.kind,
                tables.ASSIGNMENTS.c.position,
            )
            .join(tables.SESSIONS)
            .where(
                tables.ASSIGNMENTS.c.origin == origin,
                tables.ASSIGNMENTS.c.status != "freed",
                tables.ASSIGNMENTS.c.kind != "practice",
            )
        )
        return [Place(*row) for row in self._connection.execute(query)]

    def count(self, table: Table, *columns: str, **key: object) -> dict[tuple[Any, ...], int]:
        """Count rows by the values of some columns."""
        by = [table.c[name] for name in columns]
        query = sql.select(*by, sql.func.count()).select_from(table)
        query = query.where(*_equal(table, tuple(key))).group_by(*by)
        return {tuple(row[:-1]): row[-1] for row in self._connection.execute(query, _named(key))}

    def silent_since(self, moment: float, stages: Sequence[str]) -> list[str]:
        """Return the sessions in one of the stages without a sign of life since a moment."""
        sessions = tables.SESSIONS
        query = sql.select(sessions.c.id).where(sessions.c.seen < moment, sessions.c.stage.in_(stages))
        return list(self._connection.scalars(query))

    def changed_since(self, moment: float) -> list[tuple[str, int]]:
        """Return the sessions, with their revisions, that were seen since a moment."""
        sessions = tables.SESSIONS
        query = sql.select(sessions.c.id, sessions.c.revision).where(sessions.c.seen >= moment)
        return [(row[0], row[1]) for row in self._connection.execute(query)]

    def is_alive(self) -> bool:
        """Tell whether the database answers."""
        return bool(self._connection.scalar(sql.text("SELECT 1")) == 1)

    def stream(self, query: sql.Select[Any]) -> Iterator[Row]:
        """Yield a query's rows without holding them all."""
        yield from self._connection.execution_options(yield_per=1000).execute(query)


class Store:
    """A study's database.

    Parameters
    ----------
    url
        As SQLAlchemy writes it; see `sqlite_url`.
    """

    def __init__(self, url: str) -> None:
        self.url = url
        self.is_sqlite = url.startswith("sqlite")
        try:
            self.engine = open_engine(url)
            if self.is_sqlite:
                # Readers don't wait for the writer: theirs are plain, deferred transactions.
                self._reading = open_engine(url, begin="BEGIN")
                self.writer = Writer(self.engine)
            else:
                self._reading = self.engine
                self.writer = Writer(self.engine, shares_commits=False, num_threads=4)
        except (SQLAlchemyError, ImportError) as error:
            raise InputError(f"the database {_without_password(url)} can't be opened: {error}") from error

    def submit(self, job: Callable[[Transaction], T]) -> "Future[T]":
        """Let a job run that may write; see `Writer.submit`."""
        return self.writer.submit(lambda connection: job(Transaction(connection)))

    def write(self, job: Callable[[Transaction], T]) -> T:
        """Run a job that may write, and wait until what it did is on the disk."""
        return self.writer.run(lambda connection: job(Transaction(connection)))

    def read(self, job: Callable[[Transaction], T]) -> T:
        """Run a job that only reads."""
        try:
            with self._reading.connect() as connection:
                return job(Transaction(connection))
        except OperationalError as error:
            raise UnavailableError("the database does not answer") from error

    def close(self) -> None:
        """Finish what was asked for and let the database go."""
        self.writer.close()
        self.engine.dispose()
        self._reading.dispose()


def sqlite_url(folder: Path) -> str:
    """Return the address of the database embedded in a study's folder.

    Examples
    --------
    >>> sqlite_url(Path("study"))
    'sqlite:///study/study.db'
    """
    return f"sqlite:///{folder / DATABASE}"


def open_engine(url: str, *, begin: str = "BEGIN IMMEDIATE") -> Engine:
    """Open a database; SQLite so that what is committed survives the loss of power.

    Parameters
    ----------
    begin
        How SQLite's transactions begin. Immediately, so that none is rolled back because another wrote first.
    """
    engine = sql.create_engine(url, pool_pre_ping=not url.startswith("sqlite"))
    if url.startswith("sqlite"):

        @event.listens_for(engine, "connect")
        def prepare(connection: Any, _: object) -> None:  # noqa: ANN401 (each driver has its own)
            connection.isolation_level = None  # transactions begin below, not where the driver thinks
            for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON", "busy_timeout=20000"):
                connection.execute(f"PRAGMA {pragma}")

        @event.listens_for(engine, "begin")
        def start(connection: Connection) -> None:
            connection.exec_driver_sql(begin)

    return engine


def migrate(url: str) -> None:
    """Bring a database to the newest version, or make it."""
    from alembic import command
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    engine = open_engine(url)
    try:
        with engine.begin() as connection:
            config.attributes["connection"] = connection
            command.upgrade(config, "head")
    except SQLAlchemyError as error:
        raise InputError(f"the database {_without_password(url)} can't be opened: {error}") from error
    finally:
        engine.dispose()


def to_json(value: object) -> str:
    """Write a value for a text column."""
    return json.dumps(value, ensure_ascii=False, sort_keys=True)


# Statements are made once for each table and its columns: to make one takes longer than to run it.


@cache
def _insert(table: Table) -> sql.Insert:
    return table.insert()


@cache
def _update(table: Table, key: tuple[str, ...], values: tuple[str, ...]) -> sql.Update:
    changes: dict[str, Any] = {name: sql.bindparam(name) for name in values}
    return sql.update(table).where(*_equal(table, key)).values(**changes)


@cache
def _select(table: Table, key: tuple[str, ...], order: tuple[str, ...]) -> sql.Select[Any]:
    return sql.select(table).where(*_equal(table, key)).order_by(*(table.c[name] for name in order))


def _equal(table: Table, key: tuple[str, ...]) -> list[sql.ColumnElement[bool]]:
    return [table.c[name] == sql.bindparam(f"key_{name}") for name in key]


def _named(key: Mapping[str, object]) -> dict[str, object]:
    return {f"key_{name}": value for name, value in key.items()}


def _without_password(url: str) -> str:
    return sql.make_url(url).render_as_string(hide_password=True)


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

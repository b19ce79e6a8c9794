"""A study's database: opened, migrated, read from, and written to."""

from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any, TypeVar

import sqlalchemy as sql
from sqlalchemy import Connection, Engine, event
from sqlalchemy.exc import ArgumentError, DBAPIError, OperationalError, SQLAlchemyError

from explicable.errors import InputError
from explicable.study.transaction import Transaction
from explicable.study.writer import UnavailableError, Writer

T = TypeVar("T")

DATABASE = "study.db"
_PRAGMAS = (
    "journal_mode=WAL",
    "synchronous=FULL",
    "foreign_keys=ON",
    "busy_timeout=20000",
    "secure_delete=ON",  # what is erased is overwritten
)


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
            # Readers don't wait for the writer: SQLite's are plain, deferred transactions. Nor do they
            # run again if a connection is lost, as the writer does: theirs are tried before they are used.
            self._reading = open_engine(url, begin="BEGIN", tries_connections=True)
            self.writer = Writer(self.engine)
        except (SQLAlchemyError, ImportError) as error:
            raise InputError(_refusal(url, error)) from error

    def submit(self, job: Callable[[Transaction], T]) -> Future[T]:
        """Let a job run that may write; its future is done when what it did is on the disk."""
        done: Future[T] = Future()

        def tell(result: T, error: BaseException | None) -> None:
            done.set_result(result) if error is None else done.set_exception(error)

        self.writer.submit(job, tell, done.set_running_or_notify_cancel)
        return done

    def write(self, job: Callable[[Transaction], T]) -> T:
        """Run a job that may write, and wait until what it did is on the disk."""
        return self.submit(job).result()

    def read(self, job: Callable[[Transaction], T]) -> T:
        """Run a job that only reads.

        Raises
        ------
        UnavailableError
            If the database does not answer.
        """
        try:
            with self._reading.connect() as connection:
                return job(Transaction(connection))
        except OperationalError as error:
            raise UnavailableError("the database does not answer") from error

    def scrub(self) -> None:
        """Let nothing that was erased stay in the log of an embedded database."""
        if self.is_sqlite:
            connection = self._reading.raw_connection()
            try:
                connection.cursor().execute("PRAGMA wal_checkpoint(TRUNCATE)")
            finally:
                connection.close()

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


def sqlite_file(url: str) -> Path | None:
    """Return the file of an embedded database; None for a server's.

    Examples
    --------
    >>> sqlite_file("sqlite:///study/study.db").as_posix(), sqlite_file("postgresql+psycopg:///study")
    ('study/study.db', None)
    """
    return Path(url.removeprefix("sqlite:///")) if url.startswith("sqlite:///") else None


def open_engine(url: str, *, begin: str = "BEGIN IMMEDIATE", tries_connections: bool = False) -> Engine:
    """Open a database; SQLite so that what is committed survives the loss of power.

    Parameters
    ----------
    begin
        How SQLite's transactions begin. Immediately, so that none is rolled back because another wrote first.
    tries_connections
        Whether to try a server's connections before they are used, and to replace those that are lost.
    """
    engine = sql.create_engine(url, pool_pre_ping=tries_connections and not url.startswith("sqlite"))
    if url.startswith("sqlite"):

        @event.listens_for(engine, "connect")
        def prepare(connection: Any, _: object) -> None:  # noqa: ANN401 (each driver has its own)
            connection.isolation_level = None  # transactions begin below, not where the driver thinks
            for pragma in _PRAGMAS:
                connection.execute(f"PRAGMA {pragma}")

        @event.listens_for(engine, "begin")
        def start(connection: Connection) -> None:
            connection.exec_driver_sql(begin)

    return engine


def migrate(url: str) -> None:
    """Bring a database to the newest version, or make it.

    Raises
    ------
    InputError
        If there is no such database, it can't be opened, or its driver is not installed.
    """
    from alembic import command
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    try:
        engine = open_engine(url)
        try:
            with engine.begin() as connection:
                config.attributes["connection"] = connection
                command.upgrade(config, "head")
        finally:
            engine.dispose()
    except (SQLAlchemyError, ImportError) as error:
        raise InputError(_refusal(url, error)) from error


def _refusal(url: str, error: SQLAlchemyError | ImportError) -> str:
    """Say in one line why a database can't be opened; its password is nobody's business."""
    try:
        shown = sql.make_url(url).render_as_string(hide_password=True)
    except ArgumentError:
        return "that is no address of a database: it looks like postgresql+psycopg://user@host/name"
    reason = str(error.orig if isinstance(error, DBAPIError) else error).splitlines()[0]
    return f"the database {shown} can't be opened: {reason}"

"""One thread that writes: what many ask for at once is committed at once.

A durable commit waits for the disk. Requests that come meanwhile wait in a queue and share the next commit,
so that their number hardly matters; and nobody hears of success before the commit.
"""

import threading
import time
from collections.abc import Callable
from queue import SimpleQueue
from typing import Any, NamedTuple, TypeAlias

from sqlalchemy import Engine
from sqlalchemy.exc import OperationalError

from explicable.errors import ExplicableError
from explicable.study.transaction import OutdatedError, Transaction

Job: TypeAlias = Callable[[Transaction], Any]
Tell: TypeAlias = Callable[[Any, BaseException | None], None]
"""Is told what came of a job: its result, or the error."""

_MOST_AT_ONCE = 128
_GATHERING_S = 0.03
"""Seconds for which a commit waits for others, where the one before it had several."""
_MOST_REMEMBERED = 10_000


class UnavailableError(ExplicableError):
    """The database does not answer now; nothing has been written."""


class Entry(NamedTuple):
    """A job, who is told of it, and whether anybody still wants it when its turn comes."""

    job: Job
    tell: Tell
    is_wanted: Callable[[], bool]


class Writer:
    """Runs jobs in transactions, in the order in which they come.

    Jobs that wait together are run together, from what was remembered (`Transaction.recall`), and committed
    together. A job that fails then, or all of them if the database refuses them, run again from what the
    database holds, and where that fails, alone. So a job must not do anything but to talk to its transaction.

    Parameters
    ----------
    engine
        Of the database.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._memory: dict[str, object] = {}
        self._queue: SimpleQueue[Entry | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._work, name="study-writer", daemon=True)
        self._thread.start()

    def submit(self, job: Job, tell: Tell, is_wanted: Callable[[], bool]) -> None:
        """Let a job run if it is wanted when its turn comes; told by the writer when all is on the disk."""
        self._queue.put(Entry(job, tell, is_wanted))

    def close(self) -> None:
        """Finish what was asked for, then stop."""
        self._queue.put(None)
        self._thread.join()

    def _work(self) -> None:
        entry, batch = self._queue.get(), list[Entry]()
        while entry is not None:
            if len(batch) > 1:
                time.sleep(_GATHERING_S)
            batch = []
            while entry is not None:
                if entry.is_wanted():
                    batch.append(entry)
                if len(batch) == _MOST_AT_ONCE or self._queue.empty():
                    break
                entry = self._queue.get()
            left = self._run_together(batch, self._memory)
            left = self._run_together(left, {}) if len(left) > 1 else left
            for alone in left:
                self._run_alone(alone.job, alone.tell)
            entry = entry and self._queue.get()

    def _run_together(self, batch: list[Entry], memory: dict[str, object]) -> list[Entry]:
        """Run jobs in one transaction; return those of which nothing is done."""
        done, left = [], []
        try:
            with self._engine.begin() as connection:
                tx = Transaction(connection, memory)
                for entry in batch:
                    try:
                        done.append((entry.tell, tx.attempt(entry.job)))
                    except OutdatedError:
                        raise
                    except ExplicableError:
                        left.append(entry)
                tx.send()
        except Exception:  # whose fault it is shows when each runs alone
            return batch
        self._remember(tx)
        for tell, result in done:
            tell(result, None)
        return left

    def _run_alone(self, job: Job, tell: Tell) -> None:
        try:
            with self._engine.begin() as connection:
                tx = Transaction(connection)
                result = job(tx)
                tx.send()
        except OperationalError:
            tell(None, UnavailableError("the database does not answer"))
        except BaseException as error:  # the asker's to handle: this thread goes on
            tell(None, error)
        else:
            self._remember(tx)
            tell(result, None)

    def _remember(self, tx: Transaction) -> None:
        self._memory.update(tx.remembered)
        while len(self._memory) > _MOST_REMEMBERED:
            del self._memory[next(iter(self._memory))]

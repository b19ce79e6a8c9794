"""One thread that writes: what many ask for at once is committed at once.

A durable commit waits for the disk. Requests that come meanwhile wait in a queue and share the next commit,
so that their number hardly matters; and nobody hears of success before the commit.
"""

import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from queue import SimpleQueue
from typing import Any, TypeAlias, TypeVar

from sqlalchemy import Engine
from sqlalchemy.exc import OperationalError

from explicable.errors import ExplicableError
from explicable.study.transaction import OutdatedError, Transaction

T = TypeVar("T")
Entry: TypeAlias = tuple[Callable[[Transaction], Any], "Future[Any]"]

_MOST_AT_ONCE = 128
_GATHERING_S = 0.01
"""Seconds for which a commit waits for others, where the one before it had several."""
_MOST_REMEMBERED = 10_000


class UnavailableError(ExplicableError):
    """The database does not answer now; nothing has been written."""


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

    def submit(self, job: Callable[[Transaction], T]) -> "Future[T]":
        """Let a job run; its future is done when what it did is on the disk."""
        future: Future[T] = Future()
        self._queue.put((job, future))
        return future

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
                if entry[1].set_running_or_notify_cancel():
                    batch.append(entry)
                if len(batch) == _MOST_AT_ONCE or self._queue.empty():
                    break
                entry = self._queue.get()
            left = self._run_together(batch, self._memory)
            left = self._run_together(left, {}) if len(left) > 1 else left
            for job, future in left:
                self._run_alone(job, future)
            entry = entry and self._queue.get()

    def _run_together(self, batch: list[Entry], memory: dict[str, object]) -> list[Entry]:
        """Run jobs in one transaction; return those of which nothing is done."""
        done, left = [], []
        try:
            with self._engine.begin() as connection:
                tx = Transaction(connection, memory)
                for job, future in batch:
                    try:
                        done.append((future, tx.attempt(job)))
                    except OutdatedError:
                        raise
                    except ExplicableError:
                        left.append((job, future))
                tx.send()
        except Exception:  # whose fault it is shows when each runs alone
            return batch
        self._remember(tx)
        for future, result in done:
            future.set_result(result)
        return left

    def _run_alone(self, job: Callable[[Transaction], Any], future: "Future[Any]") -> None:
        try:
            with self._engine.begin() as connection:
                tx = Transaction(connection)
                result = job(tx)
                tx.send()
        except OperationalError:
            future.set_exception(UnavailableError("the database does not answer"))
        except BaseException as error:  # the asker's to handle: this thread goes on
            future.set_exception(error)
        else:
            self._remember(tx)
            future.set_result(result)

    def _remember(self, tx: Transaction) -> None:
        self._memory.update(tx.remembered)
        while len(self._memory) > _MOST_REMEMBERED:
            del self._memory[next(iter(self._memory))]

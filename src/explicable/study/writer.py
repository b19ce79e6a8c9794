"""One thread that writes: what many ask for at once is committed at once.

A durable commit waits for the disk. Requests that come meanwhile wait in a queue and share the next commit,
so that their number hardly matters; and nobody hears of success before the commit.
"""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import SimpleQueue
from typing import Any, TypeVar

from sqlalchemy import Connection, Engine
from sqlalchemy.exc import OperationalError

from explicable.errors import ExplicableError

T = TypeVar("T")
Job = Callable[[Connection], T]

_MOST_AT_ONCE = 128


class UnavailableError(ExplicableError):
    """The database does not answer now; nothing has been written."""


class Writer:
    """Runs jobs in transactions, in the order in which they come.

    Parameters
    ----------
    engine
        Of the database.
    shares_commits
        Whether jobs that wait together are committed together. A job that fails then makes all of them run
        again, each alone; so a job must not do anything but to talk to the database.
    num_threads
        More than one only where the database itself keeps jobs apart.
    """

    def __init__(self, engine: Engine, *, shares_commits: bool = True, num_threads: int = 1) -> None:
        self._engine = engine
        self._most = _MOST_AT_ONCE if shares_commits else 1
        self._queue: SimpleQueue[tuple[Job[Any], Future[Any]] | None] = SimpleQueue()
        self._threads = [
            threading.Thread(target=self._work, name=f"study-writer-{number}", daemon=True)
            for number in range(num_threads)
        ]
        for thread in self._threads:
            thread.start()

    def submit(self, job: Job[T]) -> "Future[T]":
        """Let a job run; its future is done when what it did is on the disk."""
        future: Future[T] = Future()
        self._queue.put((job, future))
        return future

    def run(self, job: Job[T]) -> T:
        """Run a job and wait for it."""
        return self.submit(job).result()

    def close(self) -> None:
        """Finish what was asked for, then stop."""
        for _ in self._threads:
            self._queue.put(None)
        for thread in self._threads:
            thread.join()

    def _work(self) -> None:
        while (first := self._queue.get()) is not None:
            batch = [first]
            is_last = False
            while len(batch) < self._most and not self._queue.empty():
                entry = self._queue.get()
                if entry is None:
                    is_last = True
                    break
                batch.append(entry)
            self._commit(batch)
            if is_last:
                return

    def _commit(self, batch: list[tuple[Job[Any], "Future[Any]"]]) -> None:
        try:
            with self._engine.begin() as connection:
                results = [job(connection) for job, _ in batch]
        except BaseException as error:
            if len(batch) == 1:
                gone = isinstance(error, OperationalError)
                batch[0][1].set_exception(UnavailableError("the database does not answer") if gone else error)
                return
            for entry in batch:
                self._commit([entry])
            return
        for (_, future), result in zip(batch, results, strict=True):
            future.set_result(result)

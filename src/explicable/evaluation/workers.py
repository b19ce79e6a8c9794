"""Who does the trials: processes of this machine, or the workers of a Dask cluster.

A trial travels as its key and comes back as its record's line: plain text, whatever carries it.
"""

import os
import re
import threading
import time
from collections.abc import Iterator, Sequence

from explicable.errors import UsageError
from explicable.evaluation.records import Trial, format_record, make_record
from explicable.evaluation.trials import perform

CONNECT_S = 30
"""Seconds to wait for a Dask scheduler."""


def run_here(trials: Sequence[Trial], jobs: int = 1) -> Iterator[bytes]:
    """Do trials on this machine, and yield their records' lines as they end.

    Parameters
    ----------
    jobs
        Number of processes; 1: this one.

    Raises
    ------
    UsageError
        If there is to be no process.
    """
    if jobs < 1:
        raise UsageError(f"there must be at least one job, not {jobs}")
    if jobs == 1 or len(trials) <= 1:
        yield from map(perform_key, (trial.key for trial in trials))
        return
    from joblib import Parallel, delayed

    run = delayed(perform_key)
    parallel = Parallel(
        n_jobs=jobs,
        return_as="generator_unordered",
        batch_size=1,
        initializer=_end_with_parent,
        initargs=(os.getpid(),),
    )
    yield from parallel(run(trial.key) for trial in trials)


def run_on_dask(trials: Sequence[Trial], address: str) -> Iterator[bytes]:
    """Do trials on the workers of a Dask cluster, and yield their records' lines as they end.

    Workers may come and go: what a worker had under way when it died is done by another, and while there are
    none this waits. A trial over which more workers died than the scheduler allows (its setting
    ``allowed-failures``, by default 3) has failed.

    Parameters
    ----------
    address
        Of the scheduler, such as ``tcp://host:8786``.

    Raises
    ------
    UsageError
        If there is no scheduler at the address.
    """
    from distributed import Client, KilledWorker, as_completed

    # Asked for what is no address, the client stands still when it is given up.
    if re.fullmatch(r"\w+://.+:\d+", address) is None:
        raise UsageError(f"a scheduler's address is like tcp://HOST:PORT, not {address!r}")
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UsageError(f"no Dask scheduler answers at {address}: {error}") from error
    with client:
        futures = client.map(perform_key, [trial.key for trial in trials], pure=False)
        trial_of = {future.key: trial for future, trial in zip(futures, trials, strict=True)}
        for future in as_completed(futures, loop=client.loop):
            if isinstance(future.exception(), KilledWorker):
                yield format_record(
                    make_record(trial_of[future.key], error="its workers died, again and again")
                )
            else:
                yield future.result()


def _end_with_parent(parent: int) -> None:
    """Let this process end when its parent has: killed, it can't tell its workers to."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def perform_key(key: str) -> bytes:
    """Do the trial that has this key, and return its record's line."""
    return format_record(perform(Trial.from_key(key)))

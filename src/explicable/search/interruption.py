"""Ctrl-C ends a search, not the process that searches: what has been found is still handed over."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


class HeldInterrupt:
    """Notes Ctrl-C, for a search to ask about; an exception could come between any two steps."""

    def __init__(self) -> None:
        self._is_pending = False

    def __call__(self, *_signal: object) -> None:
        """Note it: what Python calls on Ctrl-C."""
        self._is_pending = True

    def is_pending(self) -> bool:
        """Tell whether Ctrl-C was pressed since it is held."""
        return self._is_pending


@contextmanager
def held_interrupt() -> Iterator[HeldInterrupt]:
    """Hold Ctrl-C back; whoever holds it looks at `HeldInterrupt.is_pending` and ends in good order.

    Held within held is one. Only the main thread can hold it, and only from Python's own handling: a
    program's own handler stays in charge, and what is yielded never becomes pending.

    Examples
    --------
    >>> with held_interrupt() as interrupt:
    ...     signal.raise_signal(signal.SIGINT)
    ...     interrupt.is_pending()
    True
    """
    present = signal.getsignal(signal.SIGINT)
    if isinstance(present, HeldInterrupt):
        yield present
    elif present is signal.default_int_handler and threading.current_thread() is threading.main_thread():
        held = HeldInterrupt()
        signal.signal(signal.SIGINT, held)
        try:
            yield held
        finally:
            signal.signal(signal.SIGINT, present)
    else:
        yield HeldInterrupt()

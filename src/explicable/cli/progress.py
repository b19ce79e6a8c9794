"""A sign of life from commands that take long."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager


def is_watched() -> bool:
    """Whether standard error is a terminal; it may also be closed."""
    return sys.stderr is not None and sys.stderr.isatty()


@contextmanager
def working(text: str) -> Iterator[None]:
    """Say on standard error what is being done, as long as it takes; only on a terminal."""
    if not is_watched():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status(text):
        yield

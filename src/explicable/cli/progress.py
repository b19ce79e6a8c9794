"""A sign of life from commands that take long."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


def is_watched() -> bool:
    """Whether standard error is a terminal; it may also be closed."""
    return sys.stderr is not None and sys.stderr.isatty()


@contextmanager
def counting(num_parts: int) -> Iterator[Callable[[str], None]]:
    """Give what is told of each part that begins, and show how far it has come; only on a terminal."""
    if not is_watched():
        yield lambda _: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        bar = progress.add_task("reading", total=num_parts)
        yield lambda part: progress.update(bar, description=part, advance=1)


@contextmanager
def working(text: str) -> Iterator[None]:
    """Say on standard error what is being done, as long as it takes; only on a terminal."""
    if not is_watched():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status(text):
        yield

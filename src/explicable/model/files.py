"""Files: text in UTF-8, and files that appear whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from explicable.errors import InputError


def read_text(path: str | Path, error: type[InputError] = InputError) -> str:
    r"""Read a text file in UTF-8, without the mark that some editors put at its beginning.

    Parameters
    ----------
    error
        What to raise if it is none.

    Raises
    ------
    InputError
        If it is not UTF-8.
    OSError
        If there is no such file, or it can't be read.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_whole(Path(folder) / "plan.txt", b"\xef\xbb\xbf(wait)")
    ...     read_text(Path(folder) / "plan.txt")
    '(wait)'
    """
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as found:
        raise error(f"not a text file in UTF-8 ({found.reason})", path=path) from found


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Write a file aside, then rename it into place, so that no reader ever sees half of it.

    Missing folders are made. A symbolic link is followed; a pipe or a device is written to as it stands.

    Raises
    ------
    OSError
        With ``path`` as its file name.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_whole(Path(folder) / "plan.txt", "(wait)")
    ...     (Path(folder) / "plan.txt").read_text()
    '(wait)'
    """
    data = content.encode() if isinstance(content, str) else content
    with naming_file(path):
        if Path(path).exists() and not Path(path).is_file():
            Path(path).write_bytes(data)  # renaming would put a file in the place of, say, /dev/null
        else:
            _replace(Path(os.path.realpath(path)), data)


@contextmanager
def naming_file(path: str | Path) -> Iterator[None]:
    """Let errors of the system name the file that was asked for: not one aside, nor none (a full disk's).

    Examples
    --------
    >>> with naming_file("plan.txt"):
    ...     raise OSError(28, "No space left on device")
    Traceback (most recent call last):
    OSError: [Errno 28] No space left on device: 'plan.txt'
    """
    try:
        yield
    except OSError as error:
        error.filename = str(path)
        del error.filename2
        raise


def _replace(path: Path, data: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    # Not by tempfile: with all that it imports it would be the slowest part of start-up.
    aside = path.parent / f".explicable.{os.urandom(8).hex()}"
    try:
        with aside.open("xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        aside.replace(path)
    except BaseException:
        aside.unlink(missing_ok=True)
        raise

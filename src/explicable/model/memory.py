"""How much memory this process may still take, and how much it holds."""

import ctypes
import gc
import sys
from collections.abc import Iterator
from contextlib import suppress
from io import FileIO
from pathlib import Path


def available_memory_bytes(root: Path = Path("/")) -> int:
    """Return what the machine, and each control group around this process, have left.

    A huge number where that can't be told. `root` is where ``proc`` and ``sys`` are.

    Examples
    --------
    >>> available_memory_bytes() > 0
    True
    """
    left = _entry(f"{root}/proc/meminfo", "MemAvailable:") * 1024 or sys.maxsize
    for folder, limit, usage, cache in _control_groups(str(root)):
        allowed = _number(f"{folder}/{limit}")
        used = None if allowed is None else _number(f"{folder}/{usage}")
        if allowed is not None and used is not None and allowed - used < left:
            # Cached files count as used, but make room where it is needed.
            left = min(left, max(1, allowed - used + _entry(f"{folder}/memory.stat", cache)))
    return left


def resident_memory_bytes() -> int:
    """Return what this process holds; 0 where that can't be told."""
    return _entry("/proc/self/status", "VmRSS:") * 1024


def peak_memory_bytes() -> int:
    """Return the most that this process has held, since its start or `forget_peak_memory`.

    Examples
    --------
    >>> peak_memory_bytes() > 0
    True
    """
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return _entry("/proc/self/status", "VmHWM:") * 1024 or peak


def forget_peak_memory() -> None:
    """Let `peak_memory_bytes` count from now on, where the system can (Linux: proc(5), clear_refs)."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def return_free_memory() -> None:
    """Give back what was freed but kept for later, so that `resident_memory_bytes` is what is in use.

    Where the C library can do so (glibc); elsewhere nothing happens.
    """
    gc.collect()
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)


def _control_groups(root: str) -> Iterator[tuple[str, str, str, str]]:
    """Folders of this process's control groups, innermost first, with the names of what they hold."""
    second = ("memory.max", "memory.current", "inactive_file")
    first = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
    for line in _lines(f"{root}/proc/self/cgroup"):
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            mount, names = f"{root}/sys/fs/cgroup", second
        elif "memory" in controllers.split(","):
            mount, names = f"{root}/sys/fs/cgroup/memory", first
        else:
            continue
        parts = path.strip("/ ").split("/") if path.strip("/ ") else []
        for number in range(len(parts), -1, -1):
            yield "/".join((mount, *parts[:number])), *names


def _lines(path: str) -> list[str]:
    try:
        with FileIO(path) as file:  # without buffers: searches and groundings ask before they begin
            return file.readall().decode(errors="replace").splitlines()
    except OSError:
        return []  # another operating system, or no such group


def _number(path: str) -> int | None:
    lines = _lines(path)
    return int(lines[0]) if lines and lines[0].isdecimal() else None  # "max": no limit


def _entry(path: str, name: str) -> int:
    """Return the number in the line ``name number ...``; 0 if there is none."""
    for line in _lines(path):
        if line.startswith(name):
            words = line.split()
            if len(words) > 1 and words[0] == name:
                return int(words[1])
    return 0

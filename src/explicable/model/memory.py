"""How much memory this process may still take."""

import sys
from pathlib import Path

_MEMINFO = Path("/proc/meminfo")
_CGROUP = Path("/sys/fs/cgroup")


def available_memory_bytes() -> int:
    """Return what the machine, and the control group if there is one, have left; a huge number where unknown.

    Examples
    --------
    >>> available_memory_bytes() > 0
    True
    """
    amounts = [sys.maxsize]
    try:
        lines = _MEMINFO.read_text(encoding="ascii").splitlines()
        amounts.extend(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:"))
        limit = (_CGROUP / "memory.max").read_text(encoding="ascii").strip()
        if limit != "max":
            used = int((_CGROUP / "memory.current").read_text(encoding="ascii"))
            amounts.append(max(1, int(limit) - used))
    except OSError:
        pass  # another operating system, or no control group
    return min(amounts)

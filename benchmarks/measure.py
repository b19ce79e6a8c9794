"""What one command costs: CPU time and peak memory of its whole process tree, on one pinned core.

This file is also the launcher that starts the command. A child inherits the peak memory of whoever forks it,
so the fork happens in a bare interpreter of 9 MiB, the floor of every peak reported here.
"""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

MIB = 1 << 20


@dataclass(frozen=True, slots=True)
class Limits:
    """What a command may use: a core, CPU seconds, and bytes of address space."""

    core: int
    cpu_s: float
    memory_bytes: int = 4096 * MIB


@dataclass(frozen=True, slots=True)
class Cost:
    """What a command used: CPU seconds (user, system) of all its processes, largest resident set of one."""

    cpu_s: float
    wall_s: float
    peak_mib: float
    exit_code: int  # negative: the signal that ended it
    stdout: str
    stderr: str


def measure(command: list[str], *, cwd: Path, limits: Limits, stdin: str | None = None) -> Cost:
    """Run `command` in `cwd` under `limits`, with the file `stdin` (in `cwd`) as its input."""
    order = {
        "command": command,
        "stdin": stdin,
        "core": limits.core,
        "cpu_s": limits.cpu_s,
        "memory": limits.memory_bytes,
    }
    launcher = [sys.executable, "-I", "-S", str(Path(__file__).resolve())]
    launched = subprocess.run(
        launcher, input=json.dumps(order), cwd=cwd, capture_output=True, text=True, check=True
    )
    texts = [(cwd / name).read_text(errors="replace") for name in ("stdout.txt", "stderr.txt")]
    return Cost(*json.loads(launched.stdout), *texts)


def _become(command: list[str], stdin: str | None, core: int, cpu_s: float, memory: int) -> None:
    os.setsid()
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # or every start would compile what a user's doesn't
    os.sched_setaffinity(0, {core})
    seconds = max(1, int(cpu_s + 0.999))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    write = os.O_WRONLY | os.O_CREAT | os.O_TRUNC
    os.dup2(os.open(stdin or os.devnull, os.O_RDONLY), 0)
    os.dup2(os.open("stdout.txt", write, 0o644), 1)
    os.dup2(os.open("stderr.txt", write, 0o644), 2)
    os.execvp(command[0], command)  # noqa: S606 - there is no shell on purpose


def _launch(order: dict) -> None:
    start = time.monotonic()
    child = os.fork()
    if child == 0:
        try:
            _become(**order)
        finally:
            os._exit(127)

    def stop(*_: object) -> None:
        os.killpg(child, signal.SIGKILL)

    # A program that sleeps or is starved of its core uses no CPU time: the wall clock has a limit too.
    signal.signal(signal.SIGALRM, stop)
    signal.signal(signal.SIGINT, stop)
    signal.alarm(int(6 * order["cpu_s"]) + 30)
    _, status, used = os.wait4(child, 0)
    wall_s = time.monotonic() - start
    print(
        json.dumps(
            [used.ru_utime + used.ru_stime, wall_s, used.ru_maxrss / 1024, os.waitstatus_to_exitcode(status)]
        )
    )


if __name__ == "__main__":
    _launch(json.load(sys.stdin))

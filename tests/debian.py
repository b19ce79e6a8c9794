"""Programs that tests need and that Debian has: installed or fetched by one test process at a time."""

import fcntl
import os
import subprocess
from contextlib import contextmanager
from pathlib import Path

BUILD = Path(__file__).parents[1] / "build"


@contextmanager
def alone():
    """Wait until no other test process is in such a block: apt refuses to run twice at once."""
    BUILD.mkdir(exist_ok=True)
    with (BUILD / "debian.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def run(command, folder=None):
    """Run a program of Debian's to its end; return what it printed."""
    if command[0] == "apt-get":
        command = [*command, "-o", "DPkg::Lock::Timeout=600"]  # others may be installing something
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    options = {"cwd": folder, "env": environment, "capture_output": True, "text": True, "timeout": 1200}
    return subprocess.run(command, check=True, **options).stdout

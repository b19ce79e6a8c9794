"""A real broker for the tests: found, or fetched as a Debian package and unpacked under build/."""

import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

FOLDER = Path(__file__).parents[3] / "build" / "mosquitto"
DEPENDS = ["apt-cache", "depends", "--recurse", "--no-recommends", "--no-suggests", "--no-conflicts"]
DEPENDS += ["--no-breaks", "--no-replaces", "--no-enhances", "mosquitto"]


def find_broker():
    """Return the program and the folders of its libraries."""
    found = shutil.which("mosquitto", path=f"{os.environ['PATH']}:/usr/sbin")
    if found:
        return found, []
    program = FOLDER / "usr" / "sbin" / "mosquitto"
    if not program.exists():
        fetch()
    return str(program), [str(path) for path in (FOLDER / "usr" / "lib").glob("*-linux-*")]


def fetch():
    aside = FOLDER.with_suffix(f".{os.getpid()}")
    aside.mkdir(parents=True)
    listing = run(DEPENDS, aside)
    if "mosquitto" not in listing.split():
        run(["apt-get", "update", "-qq"], aside)
        listing = run(DEPENDS, aside)
    packages = [line for line in listing.splitlines() if line and line[0].isalnum()]
    missing = [name for name in packages if not is_installed(name)]
    run(["apt-get", "download", "-qq", *missing], aside)
    for package in aside.glob("*.deb"):
        run(["dpkg", "-x", package.name, "."], aside)
    FOLDER.parent.mkdir(parents=True, exist_ok=True)
    try:
        aside.rename(FOLDER)
    except OSError:  # another process was faster
        shutil.rmtree(aside)


def is_installed(name):
    command = ["dpkg-query", "-W", "-f", "${Status}", name]
    return "ok installed" in subprocess.run(command, capture_output=True, text=True, check=False).stdout


def run(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=True)
    return done.stdout


class BrokerProcess:
    """A broker on a free port, which can die and come back."""

    def __init__(self, folder):
        self.program, libraries = find_broker()
        self.environment = {**os.environ, "LD_LIBRARY_PATH": ":".join(libraries)}
        with socket.create_server(("127.0.0.1", 0)) as taken:
            self.port = taken.getsockname()[1]
        self.config = Path(folder) / "mosquitto.conf"
        self.config.write_text(f"listener {self.port} 127.0.0.1\nallow_anonymous true\npersistence false\n")
        self.start()

    def start(self):
        self.process = subprocess.Popen(
            [self.program, "-c", str(self.config)],
            env=self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for _ in range(200):
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
            except ConnectionRefusedError:
                time.sleep(0.05)
            else:
                return
        raise RuntimeError("the broker does not start")

    def kill(self):
        self.process.kill()
        self.process.wait()

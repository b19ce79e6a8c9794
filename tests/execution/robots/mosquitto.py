"""A real broker for the tests: found, or fetched as a Debian package and unpacked under build/."""

import os
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path

from debian import BUILD, alone, run
from ports import reserve_port

FOLDER = BUILD / "mosquitto"
DEPENDS = ["apt-cache", "depends", "--recurse", "--no-recommends", "--no-suggests", "--no-conflicts"]
DEPENDS += ["--no-breaks", "--no-replaces", "--no-enhances", "mosquitto"]


def find_broker():
    """Return the program and the folders of its libraries."""
    found = shutil.which("mosquitto", path=f"{os.environ['PATH']}:/usr/sbin")
    if found:
        return found, []
    program = FOLDER / "usr" / "sbin" / "mosquitto"
    with alone():
        if not program.exists():
            fetch()
    return str(program), [str(path) for path in (FOLDER / "usr" / "lib").glob("*-linux-*")]


def fetch():
    aside = Path(tempfile.mkdtemp(dir=BUILD))
    if os.geteuid() == 0:  # the lists may be empty, or older than the packages
        run(["apt-get", "update", "-qq"])
    packages = [line for line in run(DEPENDS).splitlines() if line and line[0].isalnum()]
    missing = [name for name in packages if not is_installed(name)]
    run(["apt-get", "download", "-qq", *missing], aside)
    for package in aside.glob("*.deb"):
        run(["dpkg", "-x", package.name, "."], aside)
    shutil.rmtree(FOLDER, ignore_errors=True)
    aside.rename(FOLDER)


def is_installed(name):
    command = ["dpkg-query", "-W", "-f", "${Status}", name]
    return "ok installed" in subprocess.run(command, capture_output=True, text=True, check=False).stdout


class BrokerProcess:
    """A broker on a free port, which can die and come back."""

    def __init__(self, folder):
        self.program, libraries = find_broker()
        self.environment = {**os.environ, "LD_LIBRARY_PATH": ":".join(libraries)}
        self.reserved, self.port = reserve_port()
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
        while self.process.poll() is None:
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=60).close()
            except OSError:
                time.sleep(0.05)
            else:
                return
        raise RuntimeError(f"the broker ended with {self.process.returncode}")

    def kill(self):
        self.process.kill()
        self.process.wait()

    def end(self):
        self.kill()
        self.reserved.close()

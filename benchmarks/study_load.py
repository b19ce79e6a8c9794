"""How many participants one study serves: simulated ones take part at once, each labelling every few seconds.

    python benchmarks/study_load.py --num 1000 --pace 2 [--workers 2 --database URL]

Prints one JSON object: what the participants measured (they run on the same machine, so their own work is in
it), the server's processor time for each label, and whether any acknowledged label was lost or doubled.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

import psutil

from explicable.execution import builtin_families
from explicable.study import schema as tables
from explicable.study.folder import make_folder, open_study
from explicable.study.simulation import Simulation


def wait_for(link: str) -> None:
    """Wait until the server is ready."""
    while True:
        try:
            with urllib.request.urlopen(f"{link}health", timeout=5):  # noqa: S310
                return
        except (urllib.error.URLError, OSError):
            time.sleep(0.1)


def processor_s(process: psutil.Process) -> float:
    """Return the processor time of a process and its children."""
    family = [process, *process.children(recursive=True)]
    return sum(sum(one.cpu_times()[:2]) for one in family)


def main() -> None:
    """Serve a study, load it, and count."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--num", type=int, default=1000)
    parser.add_argument("--pace", type=float, default=2.0, help="seconds between a participant's actions")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--database")
    parser.add_argument("--port", type=int, default=8765)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_folder(folder)
        text = (folder / "study.toml").read_text().replace("people = 5", "people = 100000")
        (folder / "study.toml").write_text(text.replace("tasks_each = 4", "tasks_each = 1"))
        command = [sys.executable, "-m", "explicable", "study", "serve", name, "--no-limits"]
        command += ["--port", str(options.port), "--workers", str(options.workers)]
        command += ["--database", options.database] if options.database else []
        server = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        link = f"http://127.0.0.1:{options.port}/"
        wait_for(link)
        process = psutil.Process(server.pid)
        before = processor_s(process)
        with open_study(folder, options.database) as opened:
            family = builtin_families()["myopic"]
            simulation = Simulation(link, opened.materials, opened.keys, family, pace_s=options.pace)
            began = time.perf_counter()
            tally = simulation.run(options.num, at_once=options.num)
            wall_s = time.perf_counter() - began
            spent_s = processor_s(process) - before
            stored = opened.store.read(lambda tx: len(tx.all(tables.LABELS)))
        server.terminate()
        server.wait()
    times = sorted(tally.answer_s)
    report = {
        "num_participants": options.num,
        "pace_s": options.pace,
        "workers": options.workers,
        "database": "postgresql" if options.database else "sqlite",
        "num_finished": tally.num_finished,
        "num_labels_acknowledged": len(tally.labels),
        "num_labels_stored": stored,
        "labels_per_s": len(tally.labels) / wall_s,
        "answer_ms_50": 1000 * times[len(times) // 2],
        "answer_ms_99": 1000 * times[int(0.99 * len(times))],
        "server_ms_per_label": 1000 * spent_s / len(tally.labels),
    }
    print(json.dumps(report, indent=2))


main()

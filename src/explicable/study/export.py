"""From the database to a data set: CSV, JSON Lines and Parquet in the layout of Psych-DS, and traces.

Tables and traces are streamed, so that their size does not matter; the folder appears whole or not at all.
"""

import csv
import hashlib
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from datetime import UTC, datetime
from importlib import metadata
from itertools import chain, groupby, islice
from pathlib import Path
from typing import IO, Any

import pyarrow as pa
import pyarrow.parquet as pq

from explicable.errors import UsageError
from explicable.labelling import LabelledStep, Trace, problem_texts
from explicable.labelling.records import format_record
from explicable.model.plan import parse_action
from explicable.study.codebook import COLUMNS, TABLES, format_codebook
from explicable.study.materials import Materials
from explicable.study.records import PRIVATE, labelled_steps, whole_table
from explicable.study.transaction import Row, Transaction

Record = Mapping[str, Any]

_BATCH = 1000
_IGNORED = "".join(
    f"{name}\n" for name in ("jsonl/**", "parquet/**", "traces/**", "checksums.json", "study.toml")
)
"""What is there besides the data set, for the validator of Psych-DS."""
_TRACE_FILES = {"person": "traces.jsonl", "simulated": "traces-simulated.jsonl"}
_TYPES = {
    "string": pa.string(),
    "integer": pa.int64(),
    "number": pa.float64(),
    "boolean": pa.bool_(),
}


def export(tx: Transaction, materials: Materials, output: Path) -> dict[str, int]:
    """Write a study's data set; return the number of rows of each table.

    Parameters
    ----------
    output
        A folder that does not exist yet, or is empty.

    Raises
    ------
    UsageError
        If there is something in the folder.
    """
    if output.exists() and (not output.is_dir() or any(output.iterdir())):
        raise UsageError(f"{output} is not an empty folder: an export never overwrites another")
    output.parent.mkdir(parents=True, exist_ok=True)
    aside = output.parent / f".explicable.{os.urandom(8).hex()}"
    aside.mkdir()
    try:
        counts, columns = {}, {}
        for table in TABLES:
            counts[table], columns[table] = _write_table(tx, materials, table, aside)
        counts["traces"] = _write_traces(tx, materials, aside)
        (aside / "CODEBOOK.md").write_text(format_codebook(columns), encoding="utf-8")
        (aside / "README.md").write_text(_readme(materials), encoding="utf-8")
        (aside / ".psychds-ignore").write_text(_IGNORED, encoding="utf-8")
        (aside / "study.toml").write_bytes((materials.folder / "study.toml").read_bytes())
        _write_json(aside / "dataset_description.json", _description(materials, columns))
        _write_json(aside / "checksums.json", {"rows": counts, "sha256": _checksums(aside)})
        if output.exists():
            output.rmdir()
        aside.rename(output)
    except BaseException:
        shutil.rmtree(aside, ignore_errors=True)
        raise
    return counts


def _rows(tx: Transaction, materials: Materials, table: str) -> Iterator[Record]:
    found: Iterator[Row] = labelled_steps(tx) if table == "labelled-steps" else whole_table(tx, table)
    for row in found:
        record = dict(row._mapping)
        if table == "labelled-steps":
            task = materials.tasks.get(record["task"])
            record["source"] = task.source if task and task.kind == "replay" else None
        yield record


def _write_table(tx: Transaction, materials: Materials, table: str, folder: Path) -> tuple[int, list[str]]:
    rows = _rows(tx, materials, table)
    first = next(rows, None)
    columns = list(first) if first else _columns_of(table)
    schema = pa.schema([(name, _TYPES[_type(table, name)]) for name in columns])
    count = 0
    with ExitStack() as stack:
        csv_file = stack.enter_context(_opened(folder / "data" / _data_file(table)))
        lines = stack.enter_context(_opened(folder / "jsonl" / f"{table}.jsonl"))
        (folder / "parquet").mkdir(exist_ok=True)
        parquet = stack.enter_context(pq.ParquetWriter(folder / "parquet" / f"{table}.parquet", schema))
        writer = csv.DictWriter(csv_file, columns)
        writer.writeheader()
        everything = chain([] if first is None else [first], rows)
        while batch := list(islice(everything, _BATCH)):
            shaped = [_shaped(table, row) for row in batch]
            writer.writerows({name: _cell(value) for name, value in row.items()} for row in shaped)
            lines.writelines(json.dumps(row, ensure_ascii=False, allow_nan=False) + "\n" for row in shaped)
            parquet.write_table(pa.Table.from_pylist(shaped, schema))
            count += len(shaped)
    return count, columns


def _columns_of(table: str) -> list[str]:
    from explicable.study.schema import METADATA

    if table == "labelled-steps":
        return ["participant", "origin", "task", "number", "operator", "explicable"]
    return [c.name for c in METADATA.tables[table].c if c.name not in PRIVATE]


def _type(table: str, column: str) -> str:
    integers = {"assignments", "events"}
    return "integer" if column == "id" and table in integers else COLUMNS[column][0]


def _shaped(table: str, row: Mapping[str, Any]) -> dict[str, Any]:
    return {
        name: bool(value) if value is not None and _type(table, name) == "boolean" else value
        for name, value in row.items()
    }


def _cell(value: object) -> object:
    """Write a value for CSV; text that a spreadsheet would take for a formula is marked as text."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r")):
        return "'" + value
    return value


def read_played(tx: Transaction, materials: Materials) -> Iterator[Trace]:
    """Yield a trace for every finished task, practice left out, as the labeller reads them."""
    for _, rows in groupby(labelled_steps(tx), key=lambda row: row.assignment):
        steps = list(rows)
        row = steps[0]
        known = row.task in materials.tasks and row.condition in materials.conditions
        if row.status != "done" or row.kind == "practice" or not known:
            continue
        material = materials.material(row.task, row.condition)
        labels = [
            LabelledStep(
                step.agent,
                parse_action(step.operator),
                None if step.explicable is None else bool(step.explicable),
                round(step.server_time - row.server_time, 3),
            )
            for step in steps
        ]
        notes = {
            "condition": row.condition,
            "kind": row.kind,
            "source": "play" if row.kind == "play" else material.task.source,
            "position": row.position,
            "study": row.study,
            "version": row.version,
            "seed": row.seed,
        }
        yield Trace(
            problem=material.problem,
            steps=tuple(labels),
            annotator=row.participant,
            origin="simulated" if row.origin == "simulated" else "person",
            semantics=material.condition.semantics if material.task.map else None,
            name=row.task,
            started=datetime.fromtimestamp(row.server_time, UTC).isoformat(timespec="seconds"),
            notes=notes,
        )


def _write_traces(tx: Transaction, materials: Materials, folder: Path) -> int:
    """Write traces of people and of simulated participants to files of their own, one after another."""
    num = 0
    texts: dict[int, dict[str, str]] = {}  # by problem, which the study keeps
    files: dict[str, IO[str]] = {}
    with ExitStack() as stack:
        for trace in read_played(tx, materials):
            if trace.origin not in files:
                path = folder / "traces" / _TRACE_FILES[trace.origin]
                files[trace.origin] = stack.enter_context(_opened(path))
            if id(trace.problem) not in texts:
                texts[id(trace.problem)] = problem_texts(trace.problem)
            files[trace.origin].write(f"{format_record(trace, texts[id(trace.problem)])}\n")
            num += 1
    return num


def _description(materials: Materials, columns: Mapping[str, list[str]]) -> dict[str, Any]:
    named = sorted({column for found in columns.values() for column in found})
    return {
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": materials.study.title,
        "description": "Labels of robots' steps, collected with explicable. Rows with origin = simulated"
        " come from simulated participants, who are test instruments and no people.",
        "variableMeasured": [
            {"@type": "PropertyValue", "name": name, "description": COLUMNS[name][1]} for name in named
        ],
        "dateCreated": datetime.now(UTC).isoformat(timespec="seconds"),
        "version": metadata.version("explicable"),
        "identifier": materials.hash,
    }


def _data_file(table: str) -> str:
    """Return the name of a table's file: Psych-DS has letters and digits between its hyphens only.

    Examples
    --------
    >>> _data_file("labelled-steps")
    'study-data_description-labelledSteps_data.csv'
    """
    first, *rest = table.split("-")
    return f"study-data_description-{first}{''.join(map(str.capitalize, rest))}_data.csv"


def _readme(materials: Materials) -> str:
    return f"""# {materials.study.title}

Labels of robots' steps in the layout of Psych-DS, collected with explicable {metadata.version("explicable")}.
Rows with origin = simulated come from simulated participants, who are test instruments and no people.

Seed of the study: {materials.study.seed}. SHA-256 of its files: {materials.hash}.

- data/: every table as CSV. An apostrophe stands in front of text that a spreadsheet would take for a
  formula; jsonl/ and parquet/ hold the same tables without it.
- traces/: finished tasks, as `explicable train` reads them.
- CODEBOOK.md: what the columns mean. checksums.json: numbers of rows, and SHA-256 of every file.
"""


def _checksums(folder: Path) -> dict[str, str]:
    sums = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        with path.open("rb") as file:
            sums[path.relative_to(folder).as_posix()] = hashlib.file_digest(file, "sha256").hexdigest()
    return sums


def _opened(path: Path) -> IO[str]:
    path.parent.mkdir(exist_ok=True)
    return path.open("w", encoding="utf-8", newline="")


def _write_json(path: Path, value: object) -> None:
    path.write_text(json.dumps(value, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")

"""Trials and their records: one JSON line each.

A record is appended as its trial ends, so that an interruption costs only what is under way. Names of numbers
that differ from run to run end in ``_s`` (seconds) or ``_bytes``; all others follow from the seed alone.
"""

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from explicable.errors import InputError, UsageError
from explicable.model.files import naming_file, write_whole

Settings = Mapping[str, Any]
"""By name: text, numbers, switches, or lists of them."""

Row = dict[str, Any]
"""One measured thing of a trial, by name."""

Seed = tuple[int, int]
"""Of an experiment and of a trial in it."""

Record = dict[str, Any]
"""A trial's key and what came of it: ``outcome`` (done or failed), ``rows``, ``error``, ``trial_s``."""

_KEY = ("experiment", "kind", "settings", "repeat", "seed")


@dataclass(frozen=True, slots=True)
class Trial:
    """One run of an experiment: everything that it depends on.

    Parameters
    ----------
    experiment
        Its name.
    kind
        What is measured.
    settings
        Of its cell.
    repeat
        Number of the trial in its cell, from 0.
    seed
        Of all its chance.
    """

    experiment: str
    kind: str
    settings: Settings
    repeat: int
    seed: Seed

    @property
    def key(self) -> str:
        """What tells this trial from others; part of its record.

        Examples
        --------
        >>> Trial("small", "plans", {"alpha": 1.0}, 0, (1, 0)).key
        '{"experiment": "small", "kind": "plans", "settings": {"alpha": 1.0}, "repeat": 0, "seed": [1, 0]}'
        """
        return json.dumps(
            {
                "experiment": self.experiment,
                "kind": self.kind,
                "settings": dict(sorted(self.settings.items())),
                "repeat": self.repeat,
                "seed": list(self.seed),
            }
        )

    @classmethod
    def from_key(cls, key: str) -> "Trial":
        """Make a trial from its key."""
        fields = json.loads(key)
        return cls(**{**fields, "seed": tuple(fields["seed"])})


class RecordFile:
    """The records of one experiment on disk.

    Parameters
    ----------
    path
        The file; it need not exist yet.

    Examples
    --------
    >>> import tempfile
    >>> trial = Trial("small", "plans", {}, 0, (0, 0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = RecordFile(Path(folder) / "small.jsonl")
    ...     file.append(make_record(trial, rows=[{"cost": 3}]))
    ...     [record["rows"] for record in file.read()]
    [[{'cost': 3}]]
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)

    def read(self) -> list[Record]:
        """Return all records; a last line that was cut off by an interruption is left out.

        Raises
        ------
        InputError
            If any other line is damaged; says which.
        """
        if not self.path.exists():
            return []
        lines = self.path.read_bytes().split(b"\n")
        records = []
        for number, line in enumerate(lines[:-1], start=1):
            try:
                record = json.loads(line)
            except ValueError as error:
                raise InputError("not a record of a trial", path=self.path, line=number) from error
            if not isinstance(record, dict) or not {*_KEY, "outcome", "rows"} <= record.keys():
                raise InputError("not a record of a trial", path=self.path, line=number)
            records.append(record)
        return records

    def append(self, record: Record) -> None:
        """Add a record; when this returns, it is on the disk."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with naming_file(self.path), self.path.open("ab") as file:
            file.write(format_record(record))
            file.flush()
            os.fsync(file.fileno())

    def resume(self, trials: Sequence[Trial]) -> list[Trial]:
        """Make the file ready to go on: drop a half-written last line and what failed.

        Returns
        -------
        list of Trial
            Those of which there is no record yet.

        Raises
        ------
        UsageError
            If the file holds records of other trials: of another experiment, or another version of it.
        """
        records = self.read()
        keys = {trial.key for trial in trials}
        if any(key_of(record) not in keys for record in records):
            raise UsageError(
                f"{self.path} holds runs of another version of the experiment:"
                " choose another folder, or delete it"
            )
        finished = [record for record in records if record["outcome"] == "done"]
        if self.path.exists():
            write_whole(self.path, b"".join(map(format_record, finished)))
        done = {key_of(record) for record in finished}
        return [trial for trial in trials if trial.key not in done]

    def put_in_order(self, trials: Iterable[Trial]) -> list[Record]:
        """Sort the file by trial, whatever the order in which they ended, and return its records."""
        places = {trial.key: place for place, trial in enumerate(trials)}
        records = sorted(self.read(), key=lambda record: places[key_of(record)])
        write_whole(self.path, b"".join(map(format_record, records)))
        return records


def make_record(
    trial: Trial, *, rows: Sequence[Record] = (), error: str | None = None, trial_s: float = 0.0
) -> Record:
    """Make the record of a trial that ended."""
    outcome = "done" if error is None else "failed"
    end = {"outcome": outcome, "error": error, "rows": list(rows), "trial_s": round(trial_s, 3)}
    record: Record = json.loads(trial.key) | end
    return record


def key_of(record: Record) -> str:
    """Return the key of the trial whose record it is."""
    return json.dumps({name: record[name] for name in _KEY})


def format_record(record: Record) -> bytes:
    """Write a record as a line."""
    return json.dumps(record, allow_nan=False, ensure_ascii=False).encode() + b"\n"


def without_measurements(value: Any) -> Any:
    """Return records, or parts of them, without the numbers that differ from run to run.

    Examples
    --------
    >>> without_measurements([{"cost": 3, "search_s": 0.1}])
    [{'cost': 3}]
    """
    if isinstance(value, dict):
        return {
            name: without_measurements(part)
            for name, part in value.items()
            if not name.endswith(("_s", "_bytes"))
        }
    return [without_measurements(part) for part in value] if isinstance(value, list) else value

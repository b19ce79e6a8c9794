"""What a trial measures: one module for each kind, each with its `Settings` and a function `measure`."""

import traceback
from collections.abc import Mapping
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import Any

from explicable.errors import UsageError
from explicable.evaluation.records import Record, Settings, Trial, make_record

KINDS: Mapping[str, str] = {
    "plans": "explicable.evaluation.trials.plans",
    "labels": "explicable.evaluation.trials.labels",
    "loops": "explicable.evaluation.trials.loops",
    "domains": "explicable.evaluation.trials.domains",
    "scaling": "explicable.evaluation.trials.scaling",
}
"""Each kind of trial and the module that does it, imported when needed."""


def perform(trial: Trial) -> Record:
    """Do a trial and return its record.

    Whatever goes wrong in a trial is its result: the record then says what, and the report lists it. Only
    Ctrl-C gets through.
    """
    import time

    from threadpoolctl import threadpool_limits

    began = time.perf_counter()
    try:
        with threadpool_limits(1):
            rows = _module(trial.kind).measure(_make_settings(trial.kind, trial.settings), trial.seed)
    except Exception as error:  # a trial that fails is a row of the report, and must not end the others
        return make_record(trial, error=_describe(error), trial_s=time.perf_counter() - began)
    return make_record(trial, rows=rows, trial_s=time.perf_counter() - began)


def check_settings(kind: str, settings: Settings) -> None:
    """Refuse a kind of trial that does not exist, and settings that it does not know.

    Raises
    ------
    UsageError
        Says which, and what is known.

    Examples
    --------
    >>> check_settings("plans", {"num_traces": "many"})
    Traceback (most recent call last):
    explicable.errors.UsageError: num_traces can't be 'many': something like 34 is expected
    """
    if kind not in KINDS:
        raise UsageError(f"unknown kind of trial {kind!r}; known are {', '.join(KINDS)}")
    _make_settings(kind, settings)


def default_settings(kind: str) -> Settings:
    """Return the settings of a kind of trial where an experiment says nothing.

    Examples
    --------
    >>> default_settings("plans")["num_traces"]
    34
    """
    return {field.name: field.default for field in fields(_module(kind).Settings)}


def _module(kind: str) -> Any:
    return import_module(KINDS[kind])


def _make_settings(kind: str, settings: Settings) -> Any:
    """Make the settings of a kind; every one has a default, whose type others must have."""
    made = _module(kind).Settings
    known = {field.name: field for field in fields(made)}
    values = {}
    for name, value in settings.items():
        if name not in known:
            raise UsageError(
                f"trials of kind {kind!r} know no setting {name!r}; known are {', '.join(known)}"
            )
        default = known[name].default
        values[name] = _fit(name, value, default)
    return made(**values)


def _fit(name: str, value: Any, default: Any) -> Any:
    if isinstance(default, tuple) and isinstance(value, list):
        return tuple(value)
    if type(default) is float and type(value) is int:
        return float(value)
    if type(value) is not type(default):
        raise UsageError(f"{name} can't be {value!r}: something like {default!r} is expected")
    return value


def _describe(error: Exception) -> str:
    """Say what went wrong and where, without the paths of this machine."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {error}{place}"

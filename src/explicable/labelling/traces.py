"""Traces: joint plans that were executed, with what a person said of the steps (docs/labelling.md).

A trace file is JSON Lines: one trace a line, complete in itself. Traces of equal problems share one
`TeamProblem`, within a call of `read_traces`: 34 traces of 16 problems parse 16 problems.
"""

import hashlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from explicable.errors import InputError, PlanError, TraceError, UsageError
from explicable.labelling.records import PARTS, LabelledStep, Origin, RecordReader, Trace, format_record
from explicable.model.files import write_whole
from explicable.model.team import TeamProblem
from explicable.pddl import format_domain, format_problem

if TYPE_CHECKING:
    from explicable.model.task import Task

__all__ = [
    "LabelledStep",
    "Origin",
    "Trace",
    "check_traces",
    "problem_checksum",
    "problem_texts",
    "read_traces",
    "split_traces",
    "write_traces",
]


def read_traces(*paths: str | Path) -> list[Trace]:
    """Read trace files, one after another.

    Raises
    ------
    TraceError
        If a line is not a trace of this version, or a step is another agent's than it says; names line and
        reason. Whether steps are applicable is left to `check_traces`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_traces(Path(folder) / "none.jsonl", [])
    ...     read_traces(Path(folder) / "none.jsonl")
    []
    """
    problems: dict[tuple[str, ...], TeamProblem] = {}
    return [trace for path in paths for trace in _read_file(Path(path), problems)]


def write_traces(path: str | Path, traces: Iterable[Trace]) -> None:
    """Write a trace file, whole or not at all; problems stand in it as PDDL.

    Examples
    --------
    See `read_traces`.
    """
    texts: dict[int, dict[str, str]] = {}
    lines = []
    for trace in traces:
        if id(trace.problem) not in texts:
            texts[id(trace.problem)] = problem_texts(trace.problem)
        lines.append(format_record(trace, texts[id(trace.problem)]))
    write_whole(path, "".join(f"{line}\n" for line in lines))


def problem_texts(problem: TeamProblem) -> dict[str, str]:
    """Write a team problem as two or four PDDL texts, by the names that a trace file uses."""
    texts = {"domain": format_domain(problem.robot.domain), "problem": format_problem(problem.robot)}
    if problem.human is not None:
        texts["human_domain"] = format_domain(problem.human.domain)
        texts["human_problem"] = format_problem(problem.human)
    return texts


def problem_checksum(problem: TeamProblem) -> str:
    """Return the SHA-256 of a team problem's PDDL: equal for equal problems, wherever they were read."""
    texts = problem_texts(problem)
    return hashlib.sha256("\0".join(texts.get(part, "") for part in PARTS).encode()).hexdigest()


def split_traces(traces: Iterable[Trace], by: Literal["problem", "annotator"]) -> dict[str, list[Trace]]:
    """Group traces by their problem's checksum or by annotator, in the order of first appearance.

    Raises
    ------
    UsageError
        If they are to be split by anything else.

    Examples
    --------
    >>> split_traces([], by="annotator")
    {}
    """
    if by not in {"problem", "annotator"}:
        raise UsageError(f"traces are split by problem or annotator, not by {by!r}")
    checksums: dict[int, str] = {}
    groups: dict[str, list[Trace]] = {}
    for trace in traces:
        key = trace.annotator
        if by == "problem":
            if id(trace.problem) not in checksums:
                checksums[id(trace.problem)] = problem_checksum(trace.problem)
            key = checksums[id(trace.problem)]
        groups.setdefault(key, []).append(trace)
    return groups


def check_traces(traces: Sequence[Trace], path: str | Path | None = None) -> list[TraceError]:
    """Execute every trace in its composite problem and list what is wrong.

    Parameters
    ----------
    traces
        As `read_traces` gives them.
    path
        File that they came from, for messages.

    Returns
    -------
    list of TraceError
        At most one a trace; ``line`` is the number of the trace, from 1. Empty if all is well.
    """
    from explicable.model.grounding import ground

    tasks: dict[int, Task | InputError] = {}
    faults = []
    for number, trace in enumerate(traces, start=1):
        if id(trace.problem) not in tasks:
            try:
                tasks[id(trace.problem)] = ground(trace.problem.composite)
            except InputError as error:
                tasks[id(trace.problem)] = error
        fault = _find_fault(trace, tasks[id(trace.problem)])
        if fault:
            faults.append(TraceError(fault, path=path, line=number))
    return faults


def _find_fault(trace: Trace, task: "Task | InputError") -> str | None:
    if isinstance(task, InputError):
        return f"problem: {task}"
    for number, step in enumerate(trace.steps, start=1):
        if fault := step.find_wrong_agent(trace.problem):
            return f"step {number}: {fault}"
    try:
        task.execute(trace.actions)
    except PlanError as error:
        return str(error)
    return None


def _read_file(path: Path, problems: dict[tuple[str, ...], TeamProblem]) -> list[Trace]:
    traces = []
    for number, line in enumerate(path.read_bytes().removeprefix(b"\xef\xbb\xbf").split(b"\n"), start=1):
        if line.strip():
            traces.append(RecordReader(path, number, problems).read(line))
    return traces

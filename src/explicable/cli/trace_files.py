"""Traces that commands learn from or look at: read, and their errors named by file and line."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from explicable.cli.printing import warn
from explicable.errors import PlanError, TraceError, UsageError

if TYPE_CHECKING:
    from explicable.labelling import Trace
    from explicable.planning import HumanModel


def read_trace_files(*files: Path) -> "list[Trace]":
    """Read trace files, each once, with a warning where one was named again; an empty one is refused.

    Raises
    ------
    TraceError
        If a file is damaged or holds no trace.
    """
    from explicable.labelling import read_traces

    traces: list[Trace] = []
    seen: set[Path] = set()
    for file in files:
        if file.resolve() in seen:
            warn(f"{file}: named more than once; its traces count once")
            continue
        seen.add(file.resolve())
        found = read_traces(file)
        if not found:
            raise TraceError("there is no trace in it", path=file)
        traces += found
    return traces


def read_labelled_traces(*files: Path) -> "list[Trace]":
    """Read traces to learn from: at least one label must be there.

    Raises
    ------
    TraceError
        If a file is damaged or holds no trace, or no step has a label.
    """
    traces = read_trace_files(*files)
    if not any(step.label is not None for trace in traces for step in trace.steps):
        raise TraceError("no step has a label: there is nothing to learn from", path=files[0])
    return traces


def find_faults(file: Path, traces: "Sequence[Trace]") -> list[TraceError]:
    """Execute the traces of a file, and list what is wrong, by line."""
    from explicable.labelling import check_traces

    faults = check_traces(traces, file)
    lines = [number for number, line in enumerate(file.read_bytes().split(b"\n"), start=1) if line.strip()]
    for fault in faults:
        fault.line = None if fault.line is None else lines[fault.line - 1]
    return faults


@contextmanager
def naming_traces(*files: Path) -> Iterator[None]:
    """Let an error about a trace that can't be executed name its file and line."""
    from explicable.labelling import read_traces

    try:
        yield
    except (PlanError, TraceError) as error:
        if error.path is None:
            for fault in (fault for file in files for fault in find_faults(file, read_traces(file))):
                raise fault from error
        raise


def read_human_model(file: Path) -> "HumanModel":
    """Learn from the traces of a file what people do; one in which nobody does anything is refused.

    Raises
    ------
    TraceError
        If the file is damaged, or nobody does anything in it; names the file.
    """
    from explicable.planning import HumanModel

    try:
        with naming_traces(file):
            return HumanModel.learn(read_trace_files(file))
    except UsageError as error:
        raise TraceError(str(error), path=file) from error

"""Records of runs as samples, and samples as cells of Markdown tables."""

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean, median


@dataclass(frozen=True, slots=True)
class Sample:
    """The values of one figure over the runs of one program on one task."""

    values: tuple[float, ...]

    def __bool__(self) -> bool:
        return bool(self.values)

    @property
    def median(self) -> float:
        """The figure that is compared."""
        return median(self.values)

    def cell(self, scale: float = 1) -> str:
        """`median [least, greatest]`, or a dash."""
        if not self:
            return "–"
        low, high = min(self.values) * scale, max(self.values) * scale
        return f"{number(self.median * scale)} [{number(low)}, {number(high)}]"


@dataclass(frozen=True, slots=True)
class Records:
    """All runs; what is said of the first invocation, and of those that measured an experiment anew."""

    header: dict
    runs: tuple[dict, ...]
    anew: dict[str, dict] = field(default_factory=dict)

    def of(self, experiment: str) -> "Records":
        """Select the runs of one experiment."""
        runs = tuple(run for run in self.runs if run["experiment"] == experiment)
        return Records(self.anew.get(experiment, self.header), runs)

    def tasks(self) -> list[str]:
        """Names of tasks, in the order of the runs."""
        return list(dict.fromkeys(run["task"] for run in self.runs))

    def programs(self) -> list[str]:
        """Names of programs, in the order of the runs."""
        return sorted({run["program"] for run in self.runs}, key=[run["program"] for run in self.runs].index)

    def sample(self, program: str, task: str, figure: str = "cpu_s") -> Sample:
        """Collect a figure over the runs on a task; empty unless every run solved it."""
        runs = [run for run in self.runs if (run["program"], run["task"]) == (program, task)]
        if any(run["outcome"] != "solved" for run in runs):
            return Sample(())
        return Sample(tuple(run[figure] for run in runs if figure in run))

    def outcome(self, program: str, task: str) -> str:
        """Say what the last run came to; empty if there was none."""
        runs = [run for run in self.runs if (run["program"], run["task"]) == (program, task)]
        return runs[-1]["outcome"] if runs else ""


def read_records(path: Path) -> Records:
    """Read the JSON lines that `run.py` wrote; a later header is that of the runs after it."""
    headers, runs, anew = [], [], {}
    for line in map(json.loads, path.read_text().splitlines()):
        if line["experiment"] == "header":
            headers.append(line)
            continue
        runs.append(line)
        if len(headers) > 1:
            anew[line["experiment"]] = headers[-1]
    return Records(headers[0], tuple(runs), anew)


def geometric_mean(values: Iterable[float]) -> float:
    """Of positive values; NaN of none."""
    logs = [math.log(value) for value in values]
    return math.exp(fmean(logs)) if logs else math.nan


def agile_score(sample: Sample, limit_s: float = 30) -> float:
    """Score as the planning competition does: 1 up to a second, then 1 - log T / log limit, else 0."""
    if not sample or sample.median > limit_s:
        return 0.0
    return 1 - math.log(max(1.0, sample.median)) / math.log(limit_s)


def number(value: float) -> str:
    """Three significant digits, without an exponent."""
    if math.isnan(value):
        return "–"
    digits = 2 - math.floor(math.log10(abs(value))) if value else 0
    return f"{round(value, digits):.{max(0, min(digits, 4))}f}"


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Make a table; the first column is left-aligned, the others right-aligned."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"

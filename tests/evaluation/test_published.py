"""Every figure that README and docs print comes from a record: pages say what their records say."""

import json
import lzma
import re
import shutil
import sys
from pathlib import Path
from subprocess import run

import pytest

from explicable.evaluation.answers import answer
from explicable.evaluation.experiments import builtin_experiments
from explicable.evaluation.page import render_markdown
from explicable.evaluation.results import make_page
from explicable.evaluation.runner import read_records

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BENCHMARKS = ROOT / "benchmarks"
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")


def test_results_follow_from_their_records(tmp_path):
    (tmp_path / "records").mkdir()
    for packed in (DOCS / "records").glob("*.jsonl.xz"):
        with lzma.open(packed) as source, (tmp_path / "records" / packed.stem).open("wb") as target:
            shutil.copyfileobj(source, target)
    experiments = builtin_experiments()
    told = json.loads((DOCS / "records" / "run.json").read_text())
    made = render_markdown(make_page(experiments, read_records(experiments, tmp_path), told))
    published = (DOCS / "results.md").read_text()
    assert NUMBER.sub("#", made) == NUMBER.sub("#", published)
    numbers = [list(map(float, NUMBER.findall(text))) for text in (made, published)]
    assert numbers[0] == pytest.approx(numbers[1], rel=0.02, abs=0.002)  # the last digit, on other machines


def test_every_question_is_answered_in_the_results():
    published = (DOCS / "results.md").read_text()
    for experiment in builtin_experiments():
        assert f"## {experiment.question}\n" in published


def test_benchmark_pages_follow_from_their_records(tmp_path):
    page = tmp_path / "benchmarks.md"
    records = [BENCHMARKS / "records" / "benchmarks.jsonl", BENCHMARKS / "notes.md"]
    run([sys.executable, BENCHMARKS / "page.py", *records, page], check=True)
    assert page.read_text() == (DOCS / "benchmarks.md").read_text()
    show = "import closed_loop as loop; print(*loop.page(*loop.read(loop.RECORDS)), sep='\\n')"
    made = run([sys.executable, "-c", show], cwd=BENCHMARKS, capture_output=True, text=True, check=True)
    assert made.stdout == (DOCS / "closed-loop.md").read_text()


MEASURED = re.compile(
    r"(?<!at most )(?<![\d.])\d[\d.]* ?(ms|µs|microseconds|milliseconds|[KMG]i?B|labels/s)\b"  # times, sizes
    r"|\d (\w+ )?a second\b|\d times\b|\d \[-?\d|\bn = \d"  # rates, ratios, intervals
    r"|(?<![\w./])[-+]?0\.\d\d+\b"  # shares
)
RECORD = re.compile(r"(?:benchmarks/)?records(?:/[\w.-]+)?|results\.md|benchmarks\.md|closed-loop\.md")
MADE = {DOCS / name for name in ("results.md", "benchmarks.md", "closed-loop.md")}
"""Pages that are made from records as a whole, see above."""
QUOTED = {"## 8. Slips in the paper, for the record"}
"""Figures that others have published."""


@pytest.mark.parametrize(
    "page", [ROOT / "README.md", *sorted(set(DOCS.glob("*.md")) - MADE)], ids=lambda path: path.name
)
def test_what_measures_something_names_its_records(page):
    """Section by section; examples (code, and what it prints) aside."""
    text = re.sub(r"```.*?```|`--[^`]*`", "", page.read_text(), flags=re.DOTALL)
    for section in re.split(r"(?m)^(?=## )", text):
        lines = [line for line in section.splitlines() if not line.startswith(">") and MEASURED.search(line)]
        if lines and section.splitlines()[0] not in QUOTED:
            named = RECORD.findall(section)
            assert named, lines
            assert all((ROOT / name).exists() or (DOCS / name).exists() for name in named), named


def test_figures_of_other_domains_follow_from_their_records():
    (experiment,) = (one for one in builtin_experiments() if one.name == "domains")
    with lzma.open(DOCS / "records" / "domains.jsonl.xz", "rt") as packed:
        records = [json.loads(line) for line in packed]
    (scores,) = [table for table in answer(experiment, records).tables if table.name == "scores"]
    made = {row[0]: row for row in scores.rows}
    page = (DOCS / "planning.md").read_text()
    printed = re.findall(r"(?m)^\| (\S+, \w+), (own plans \d, doubt \S+) \| (.+) \| (.+) \| (.+) \|$", page)
    assert len(printed) == 30
    for cell, training, plan, *figures in printed:
        row = made[f"{cell}, mixed play, {training}: {plan}"]
        numbers = [list(map(float, NUMBER.findall(text))) for text in (*figures, *row[2:4])]
        assert [*numbers[0], *numbers[1]] == pytest.approx([*numbers[2], *numbers[3]], rel=0.02, abs=0.002)

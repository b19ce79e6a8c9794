"""docs/results.md says what its records say, and nothing else."""

import json
import lzma
import re
import shutil
from pathlib import Path

import pytest

from explicable.evaluation.experiments import builtin_experiments
from explicable.evaluation.page import render_markdown
from explicable.evaluation.results import make_page
from explicable.evaluation.runner import read_records

DOCS = Path(__file__).parents[2] / "docs"
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")


def test_results_follow_from_their_records(tmp_path):
    (tmp_path / "records").mkdir()
    for packed in (DOCS / "records").glob("*.jsonl.xz"):
        with lzma.open(packed) as source, (tmp_path / "records" / packed.stem).open("wb") as target:
            shutil.copyfileobj(source, target)
    experiments = builtin_experiments()
    run = json.loads((DOCS / "records" / "run.json").read_text())
    made = render_markdown(make_page(experiments, read_records(experiments, tmp_path), run))
    published = (DOCS / "results.md").read_text()
    assert NUMBER.sub("#", made) == NUMBER.sub("#", published)
    numbers = [list(map(float, NUMBER.findall(text))) for text in (made, published)]
    assert numbers[0] == pytest.approx(numbers[1], rel=0.02, abs=0.002)  # the last digit, on other machines


def test_every_question_is_answered_in_the_results():
    published = (DOCS / "results.md").read_text()
    for experiment in builtin_experiments():
        assert f"## {experiment.question}\n" in published

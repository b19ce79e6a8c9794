"""What several tests of the study need, and takes its time to make."""

import pytest
from browser import chromium

from explicable.cli import run


@pytest.fixture(scope="module")
def browser():
    with chromium() as running:
        yield running


@pytest.fixture(scope="module")
def labeller(tmp_path_factory):
    """A labeller's file, learnt from simulated participants' traces."""
    folder = tmp_path_factory.mktemp("labeller")
    maps, traces, path = folder / "maps", folder / "traces.jsonl", folder / "labeller.json"
    assert run(["first-response", "generate", "--num", "2", "-o", str(maps)]) == 0
    files = [str(file) for file in sorted(maps.glob("*.map"))]
    options = ["--num", "4", "--semantics", "exclusive", "-o", str(traces)]
    assert run(["first-response", "simulate", *files, *options]) == 0
    assert run(["train", str(traces), "-o", str(path), "--bootstrap", "0"]) == 0
    return path

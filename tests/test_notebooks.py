"""The notebooks run from top to bottom, and draw; they are kept without outputs."""

import tempfile
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from traitlets.config import Config

NOTEBOOKS = sorted((Path(__file__).parents[1] / "docs" / "notebooks").glob("*.ipynb"))


@pytest.fixture
def sockets():
    """A folder with a short name: that of a socket may have no more than a hundred bytes."""
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("default")  # of the kernel's machinery
def test_notebook_runs_and_draws(path, tmp_path, sockets, monkeypatch):
    notebook = nbformat.read(path, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code)
    for folder in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR", "MPLCONFIGDIR"):  # none is shared with other kernels
        monkeypatch.setenv(folder, str(sockets / folder.lower()))
    # Sockets are files: a port that was free a moment ago can be another's by now.
    config = Config({"AsyncKernelManager": {"transport": "ipc", "ip": str(sockets / "kernel")}})
    where = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, config=config, timeout=1200, startup_timeout=600, resources=where).execute()
    kinds = [kind for cell in code for output in cell.outputs for kind in output.get("data", {})]
    assert "image/svg+xml" in kinds


def test_there_are_notebooks():
    assert {path.stem for path in NOTEBOOKS} >= {
        "analyse-a-study",
        "plan-and-draw",
        "train-on-your-traces",
    }

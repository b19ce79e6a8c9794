"""The code in README and docs runs as printed: commands of `explicable` and Python, from top to bottom."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*/README.md"))
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *EXAMPLES]
BLOCK = re.compile(r"^```(python|sh)\n(.*?)^```", flags=re.MULTILINE | re.DOTALL)


def run_commands(text, page):
    for line in text.replace("\\\n", " ").splitlines():
        program, *arguments = shlex.split(line, comments=True)
        assert program == "explicable", (
            f"{page}: commands to be typed at other programs go into a plain block"
        )
        subprocess.run([sys.executable, "-m", "explicable", *arguments], check=True, timeout=1200)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_code_runs_as_printed(page, tmp_path, monkeypatch):
    """An example's page is read in the example's folder, any other in an empty one beside the examples."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path / "examples" / page.parent.name if page in EXAMPLES else tmp_path)
    namespace = {}
    for language, text in BLOCK.findall(page.read_text()):
        if language == "python":
            exec(compile(text, page.name, "exec"), namespace)  # noqa: S102 (our own pages)
        else:
            run_commands(text, page.name)

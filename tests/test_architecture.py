"""The house rules that a machine can check."""

import pkgutil
import re
import subprocess
import sys
from pathlib import Path

from importlinter.cli import lint_imports

import explicable.planning

ROOT = Path(__file__).parents[1]


CORE_USERS = re.compile(r"search/|labelling/|model/(task|grounding)\.py")


def test_imports_run_downwards():
    assert lint_imports() == 0


def test_only_the_kernels_faces_touch_the_compiled_core():
    package = ROOT / "src" / "explicable"
    users = {
        path.relative_to(package).as_posix() for path in package.rglob("*.py") if "_core" in path.read_text()
    }
    assert {path for path in users if not CORE_USERS.match(path)} == set()


def importers_of(library):
    package = ROOT / "src" / "explicable"
    imports = re.compile(rf"^\s*(from|import) {library}\b", flags=re.MULTILINE)
    return {p.relative_to(package).as_posix() for p in package.rglob("*.py") if imports.search(p.read_text())}


def test_only_the_studys_store_touches_the_database_and_only_its_app_the_web():
    store = {f"study/{name}.py" for name in ("store", "transaction", "records", "schema", "writer")}
    migrations = {path for path in importers_of("sqlalchemy") if path.startswith("study/migrations/")}
    assert importers_of("sqlalchemy") - migrations <= store | {"cli/study.py"}
    faces = "app interface refusals visits admin editor server forms pages"
    web = {f"study/{name}.py" for name in faces.split()} | {"cli/study.py"}
    in_study = {path for path in importers_of("starlette") if path.startswith("study/")}
    assert importers_of("fastapi") <= web
    assert in_study <= web | {"study/security.py"}


def test_the_command_line_starts_without_heavy_libraries():
    listing = "import sys, explicable.cli; explicable.cli.run(['plan', '--help']); print(sorted(sys.modules))"
    shown = subprocess.run([sys.executable, "-c", listing], capture_output=True, text=True, check=True).stdout
    for heavy in ("scipy", "sklearn", "rich", "jinja2"):
        assert f"'{heavy}'" not in shown


def test_no_public_name_is_that_of_a_package():
    """A name that is imported when asked for would give way to its namesake once that is imported."""
    for package in (explicable, explicable.planning):
        assert {module.name for module in pkgutil.iter_modules(package.__path__)}.isdisjoint(package.__all__)


def test_what_commands_print_goes_through_one_place():
    for path in (ROOT / "src" / "explicable" / "cli").glob("*.py"):
        if path.name != "printing.py":
            assert "click.echo" not in path.read_text(), path


def test_constraints_name_versions_and_no_addresses():
    lines = (ROOT / "constraints.txt").read_text().split()
    assert lines
    assert all(re.fullmatch(r"[A-Za-z0-9_.-]+==[A-Za-z0-9.+!]+", line) for line in lines)

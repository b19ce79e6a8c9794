"""Packages that not everybody installs: whoever needs them is told so before the work begins."""

from importlib.util import find_spec

import click


def require(extra: str, *packages: str) -> None:
    """Refuse to begin without the packages of one of the extras.

    Raises
    ------
    click.UsageError
        If one of them is not installed.
    """
    for package in packages:
        if find_spec(package) is None:
            raise click.UsageError(f"this needs {package}: pip install 'explicable[{extra}]'")

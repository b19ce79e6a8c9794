"""All that commands print goes through here, so that no file speaks to the terminal that it is shown on."""

import sys

import click

from explicable.errors import visible


def echo(text: object = "", *, err: bool = False, nl: bool = True) -> None:
    """Print a text, whose characters can't move, hide or turn around what the terminal shows.

    A pipe or a file gets the text as it is, so that a plan can be read back.
    """
    stream = sys.stderr if err else sys.stdout
    is_shown = err or (stream is not None and stream.isatty())
    click.echo(visible(str(text), besides="\n\t") if is_shown else text, err=err, nl=nl, color=True)


def complain(problem: object) -> None:
    """Say on standard error, on one line, what is wrong."""
    echo(f"explicable: {visible(str(problem))}", err=True)


def warn(warning: object) -> None:
    """Say on standard error what may be wrong, and go on."""
    complain(f"warning: {warning}")

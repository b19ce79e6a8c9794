"""The command line: the only place that prints and chooses exit codes.

===== =========================================================================
exit  meaning
===== =========================================================================
0     solved, or done; also if whoever read the output has closed the pipe
1     some trials of an evaluation failed; its report lists them
2     wrong usage: unknown option, missing argument, impossible value
3     bad input: a file that is damaged, ill-typed or does not fit
4     the problem is proved unsolvable
5     a limit was reached (time, memory, evaluations) before a plan was found
130   interrupted with Ctrl-C before there was anything to give
===== =========================================================================
"""

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

import click

from explicable.cli.printing import complain, echo
from explicable.errors import ExplicableError, ResourceError, UsageError

EXIT_TRIALS_FAILED = 1
EXIT_USAGE = 2
EXIT_BAD_INPUT = 3
EXIT_UNSOLVABLE = 4
EXIT_LIMIT = 5
EXIT_INTERRUPTED = 130

# Command -> module that defines it, imported when its command is called: so start-up stays short.
COMMANDS = {
    "demo": "explicable.cli.demo",
    "team": "explicable.cli.team",
    "plan": "explicable.cli.plan",
    "schedule": "explicable.cli.schedule",
    "simulate": "explicable.cli.simulate",
    "train": "explicable.cli.train",
    "label": "explicable.cli.labels",
    "explain": "explicable.cli.explain",
    "tell": "explicable.cli.explain",
    "measure": "explicable.cli.measures",
    "rank": "explicable.cli.measures",
    "front": "explicable.cli.front",
    "traces": "explicable.cli.traces",
    "evaluate": "explicable.cli.evaluate",
    "play": "explicable.cli.game",
    "replay": "explicable.cli.replay",
    "first-response": "explicable.cli.first_response",
    "study": "explicable.cli.study",
}


class ReaderGoneError(Exception):
    """Whoever read our output, such as `head`, has enough of it."""


@contextmanager
def _noticing_closed_pipes() -> Iterator[None]:
    """Turn the error of a closed pipe into one of ours: for that of its own click leaves with code 1."""
    try:
        yield
    except BrokenPipeError as error:
        raise ReaderGoneError from error


class LazyGroup(click.Group):
    """A group of commands that imports the command's module when it is needed."""

    def make_context(self, *arguments: Any, **options: Any) -> click.Context:
        """Read the command line; `--help` and `--version` answer here."""
        with _noticing_closed_pipes():
            return super().make_context(*arguments, **options)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        with _noticing_closed_pipes():
            return super().invoke(ctx)

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 (the signature is click's)
        """Commands in the order of the table above."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002 (as above)
        """Import the module that defines the command, and take it from there."""
        if cmd_name not in COMMANDS:
            return None
        module = import_module(COMMANDS[cmd_name])
        command = getattr(module, cmd_name.replace("-", "_"))
        if not isinstance(command, click.Command):
            raise TypeError(f"{COMMANDS[cmd_name]} has no command {cmd_name!r}")
        return command


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="explicable")
def explicable() -> None:
    """Robot plans that human teammates expect."""


def main() -> None:
    """Run the command line and leave with one of the documented exit codes."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Run one command; errors become one message on standard error and an exit code."""
    try:
        outcome = explicable.main(arguments, prog_name="explicable", standalone_mode=False)
    except click.ClickException as error:
        message = io.StringIO()
        error.show(message)
        echo(message.getvalue(), err=True, nl=False)
        return error.exit_code
    except (click.Abort, KeyboardInterrupt):
        echo("interrupted", err=True)
        return EXIT_INTERRUPTED
    except ReaderGoneError:
        _discard_output()
        return 0
    except UsageError as error:
        return _fail(error, EXIT_USAGE)
    except ResourceError as error:
        return _fail(error, EXIT_LIMIT)
    except MemoryError:
        return _fail("limit reached: out of memory", EXIT_LIMIT)
    except ExplicableError as error:
        return _fail(error, EXIT_BAD_INPUT)
    except OSError as error:
        # Files are named by those who write them; what is printed has no name.
        place = error.filename or ("standard output" if error.errno == errno.ENOSPC else None)
        return _fail(f"{place}: {error.strerror}" if place else error.strerror or error, EXIT_BAD_INPUT)
    return outcome if isinstance(outcome, int) else 0


def _fail(error: object, code: int) -> int:
    complain(error)
    return code


def _discard_output() -> None:
    """Lead standard output nowhere, so that Python does not fail to write what is left of it at its end."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)

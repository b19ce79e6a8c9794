"""What commands share about their results: exit codes, and the option to have them as JSON."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from explicable.cli import EXIT_INTERRUPTED, EXIT_LIMIT, EXIT_UNSOLVABLE
from explicable.cli.printing import echo

if TYPE_CHECKING:
    from explicable.planning import TeamPlan, ToldPlan
    from explicable.search import Outcome

json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")


def hand_over(text: str | None, output: Path | None, record: dict[str, Any] | None, reason: str) -> None:
    """Write a plan to a file, or else print it; say why where there is none.

    Parameters
    ----------
    text
        The plan, if there is one.
    record
        The JSON object that is printed in the place of plan and reason, if that was asked for.
    reason
        Why there is no plan.
    """
    from explicable.model.files import write_whole

    if output and text:
        write_whole(output, text)
    if record is not None:
        echo(json.dumps(record))
    elif not text:
        echo(f"no plan: {reason}", err=True)
    elif not output:
        echo(text, nl=False)


def exit_code(result: "TeamPlan | ToldPlan") -> int:
    """Exit code of a plan's outcome; a plan in hand is success, however the search ended."""
    return 0 if result.plan is not None else failure_code(result.outcome)


def failure_code(outcome: "Outcome") -> int:
    """Exit code where there is no plan."""
    from explicable.search import Outcome

    codes = {
        Outcome.UNSOLVABLE: EXIT_UNSOLVABLE,
        Outcome.LIMIT: EXIT_LIMIT,
        Outcome.INTERRUPTED: EXIT_INTERRUPTED,
    }
    return codes[outcome]

"""What commands share about their results: exit codes, and the option to have them as JSON."""

from typing import TYPE_CHECKING

import click

from explicable.cli import EXIT_INTERRUPTED, EXIT_LIMIT, EXIT_UNSOLVABLE

if TYPE_CHECKING:
    from explicable.planning import TeamPlan, ToldPlan
    from explicable.search import Outcome

json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")


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

"""Budgets in the place of alpha: the same words for every command."""

import functools
from collections.abc import Callable
from typing import Any, TypedDict

import click


class Budget(TypedDict):
    """What `explicable.planning.choose` asks for."""

    max_cost_increase: float | None
    min_explicability: float | None


class Share(click.ParamType[float]):
    """A share, as ``0.1`` or ``10%``."""

    name = "share"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Read a share."""
        text = str(value).strip()
        try:
            return float(text[:-1]) / 100 if text.endswith("%") else float(text)
        except ValueError:
            self.fail(f"{value!r} is no share such as 0.1 or 10%", param, ctx)


def budget_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the two budgets; it gets them as one `budget`, None where neither was given."""

    @click.option(
        "--max-cost-increase",
        metavar="SHARE",
        type=Share(),
        help="Choose the most explicable plan that is at most so much dearer than the cheapest: 10% or 0.1.",
    )
    @click.option(
        "--min-explicability",
        metavar="SHARE",
        type=Share(),
        help="Choose a plan whose expected F is at least this: 0.9 or 90%. Alone: the cheapest such plan.",
    )
    @functools.wraps(command)
    def with_budget(
        *arguments: Any, max_cost_increase: float | None, min_explicability: float | None, **options: Any
    ) -> Any:
        budget = None
        if max_cost_increase is not None or min_explicability is not None:
            from explicable.planning import choose

            budget = Budget(max_cost_increase=max_cost_increase, min_explicability=min_explicability)
            choose((), **budget)  # refused before anything is searched
        return command(*arguments, budget=budget, **options)

    return with_budget

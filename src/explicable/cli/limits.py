"""Options of `plan`: what its search may take."""

import functools
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypedDict

import click

from explicable.cli.files import FiniteRange
from explicable.errors import ResourceError

_ADDRESSABLE = 1 << 62  # bytes: more is no limit at all


class MemorySize(click.ParamType[int]):
    """Bytes, or a number with a unit: ``1GiB``, ``1.5 GB``, ``512m``."""

    name = "size"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Return the number of bytes."""
        found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([kmgt]?)(i?)b?\s*", str(value).lower())
        if not found or (found[3] and not found[2]):
            self.fail(f"{value!r} is no amount of memory such as 1GiB, 512MiB or 2GB", param, ctx)
        if len(found[1]) > 300:
            self.fail("so much memory there is not", param, ctx)
        unit = 1024 if found[3] or not str(value).lower().rstrip().endswith("b") else 1000
        return min(int(float(found[1]) * unit ** " kmgt".index(found[2] or " ")), _ADDRESSABLE)


class SearchLimits(TypedDict):
    """What `explicable.planning` takes as the limits of one search."""

    time_limit_s: float | None
    memory_limit_bytes: int | None
    max_evaluations: int | None
    seed: int


@dataclass(frozen=True, slots=True)
class Limits:
    """What a command may take, reading and grounding included; None: as much as there is."""

    time_s: float | None
    memory_bytes: int | None
    max_evaluations: int | None
    seed: int

    def memory_left_bytes(self) -> int | None:
        """Return what the limit on the whole process leaves to what comes next.

        Raises
        ------
        ResourceError
            If nothing is left.
        """
        if self.memory_bytes is None:
            return None
        from explicable.model.memory import resident_memory_bytes

        held = resident_memory_bytes()
        if held >= self.memory_bytes:
            raise ResourceError(
                f"memory limit reached: {self.memory_bytes >> 20} MiB are allowed"
                f" and {held >> 20} MiB already taken"
            )
        return self.memory_bytes - held

    def of_search(self) -> SearchLimits:
        """Return what is left to a search that begins now."""
        left = self.memory_left_bytes()
        return {
            "time_limit_s": self.time_s,
            # A third as much again passes through the hands of containers that grow.
            "memory_limit_bytes": None if left is None else left * 3 // 4,
            "max_evaluations": self.max_evaluations,
            "seed": self.seed,
        }


def limit_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options that limit its search; it receives `limits`."""

    @click.option("--time-limit", type=FiniteRange(min=0), help="Seconds that the search may take.")
    @click.option(
        "--memory-limit",
        type=MemorySize(),
        metavar="SIZE",
        help="What the process may take, such as 1GiB or 500MB, grounding and search alike."
        " Default: most of what the machine and its control group have left.",
    )
    @click.option(
        "--max-evaluations", type=click.IntRange(min=0), help="How many states the search may evaluate."
    )
    @click.option("--seed", type=int, default=0, show_default=True, help="Breaks ties.")
    @functools.wraps(command)
    def with_limits(
        *arguments: Any,
        time_limit: float | None,
        memory_limit: int | None,
        max_evaluations: int | None,
        seed: int,
        **options: Any,
    ) -> Any:
        limits = Limits(time_limit, memory_limit, max_evaluations, seed)
        return command(*arguments, limits=limits, **options)

    return with_limits

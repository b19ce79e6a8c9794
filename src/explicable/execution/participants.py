"""Simulated participants: test instruments that stand in for a person, and never for evidence about people.

A participant is a handful of parameters. What it believes while it plays is its `mind`.
"""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

from explicable.errors import InputError, UsageError
from explicable.model.files import read_text

if TYPE_CHECKING:
    import numpy as np

Horizon = Literal["request", "mission"]
Judgement = Literal["regret", "boltzmann"]

_WORDS: Mapping[str, tuple[str, ...]] = {"horizon": get_args(Horizon), "judgement": get_args(Judgement)}
_PROBABILITIES = ("noise", "learning", "memory", "readiness")
_COSTS = ("slack", "temperature")
_SWITCHES = ("initiative",)


@dataclass(frozen=True, slots=True)
class Participant:
    """How one simulated participant judges and acts.

    Parameters
    ----------
    name
        The annotator's name in traces, for example ``simulated-myopic-1``.
    horizon
        What a robot step is held against: the fulfilment of the last request, or the team's whole mission.
    judgement
        ``regret``: a step is inexplicable if it costs more than ``slack`` extra on the best way believed in.
        ``boltzmann``: with probability ``1 - p(step) / p(best step)``, where
        ``p = softmax(-cost / temperature)``.
    slack, temperature
        In the unit of cost.
    noise
        Probability that an answer is given the wrong way round.
    learning
        Probability to work out which fact stands in the way when the robot avoids the way believed best.
    memory
        Probability, per robot step, to still know a fact so learnt.
    readiness
        Probability, after each robot step, to think the present request over.
    initiative
        Whether the robot is expected to act when nothing is asked for; otherwise it is expected to wait.

    Raises
    ------
    UsageError
        If a parameter is out of its range.

    Examples
    --------
    >>> Participant("simulated-1", slack=2.0).horizon
    'request'
    """

    name: str
    horizon: Horizon = "request"
    judgement: Judgement = "regret"
    slack: float = 0.0
    temperature: float = 1.0
    noise: float = 0.0
    learning: float = 0.0
    memory: float = 1.0
    readiness: float = 0.0
    initiative: bool = False

    def __post_init__(self) -> None:
        for parameter in fields(self):
            if parameter.name != "name":
                fault = _fault(parameter.name, getattr(self, parameter.name))
                if fault:
                    raise UsageError(fault)


@dataclass(frozen=True, slots=True)
class Family:
    """Participants of one kind: fixed parameters, and ranges from which each draws its own.

    Examples
    --------
    >>> import numpy as np
    >>> family = Family("patient", {"slack": 2.0}, {"noise": (0.0, 0.1)})
    >>> family.draw(7, np.random.default_rng(0)).name
    'simulated-patient-7'
    """

    name: str
    fixed: Mapping[str, str | float | bool]
    ranges: Mapping[str, tuple[float, float]]

    def draw(self, number: int, rng: "np.random.Generator") -> Participant:
        """Make participant ``number`` of this family."""
        drawn = {name: float(rng.uniform(low, high)) for name, (low, high) in self.ranges.items()}
        # Names and values were checked when the family was read.
        return Participant(f"simulated-{self.name}-{number}", **self.fixed, **drawn)  # type: ignore[arg-type]


def builtin_families() -> dict[str, Family]:
    """Read the families that come with the package, by name.

    Examples
    --------
    >>> list(builtin_families())
    ['myopic', 'mission', 'boltzmann']
    """
    file = resources.files("explicable.execution") / "families.toml"
    return parse_families(file.read_text(encoding="utf-8"), "families.toml")


def read_families(path: str | Path) -> dict[str, Family]:
    """Read a file of families; see `parse_families`."""
    return parse_families(read_text(path), path)


def parse_families(text: str, path: str | Path | None = None) -> dict[str, Family]:
    r"""Read families: one TOML table each; a number is fixed, a pair is a range.

    Raises
    ------
    InputError
        If it is not TOML, or a parameter is unknown or out of its range; names family and parameter.

    Examples
    --------
    >>> parse_families("[calm]\nslack = 2\nnoise = [0, 0.1]")["calm"].ranges
    {'noise': (0.0, 0.1)}
    """
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"not TOML: {error}", path=path) from error
    if not tables:
        raise InputError("no family of participants in it", path=path)
    return {name: _family(name, table, path) for name, table in tables.items()}


def _family(name: str, table: object, path: str | Path | None) -> Family:
    if not isinstance(table, dict):
        raise InputError(f"expected a table [family], found the single value {name!r}", path=path)
    fixed: dict[str, str | float | bool] = {}
    ranges: dict[str, tuple[float, float]] = {}
    for parameter, value in table.items():
        ends = value if isinstance(value, list) else [value]
        fault = next(filter(None, (_fault(parameter, end) for end in ends)), None)
        if fault is None and isinstance(value, list):
            in_order = len(ends) == 2 and parameter in _COSTS + _PROBABILITIES and ends[0] <= ends[1]
            fault = None if in_order else f"{parameter} must be a single value or a range [low, high]"
        if fault is not None:
            raise InputError(f"family {name!r}: {fault}", path=path)
        if isinstance(value, list):
            ranges[parameter] = (float(ends[0]), float(ends[1]))
        else:
            fixed[parameter] = value
    return Family(name, fixed, ranges)


def _fault(parameter: str, value: object) -> str | None:
    """Say what is wrong with a parameter's value, if anything."""
    number = value if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
    if parameter in _WORDS:
        words = _WORDS[parameter]
        return None if value in words else f"{parameter} must be one of {', '.join(words)}, not {value!r}"
    if parameter in _SWITCHES:
        return None if isinstance(value, bool) else f"{parameter} must be true or false, not {value!r}"
    if parameter in _PROBABILITIES:
        return None if 0 <= number <= 1 else f"{parameter} must be a probability, not {value!r}"
    if parameter in _COSTS:
        least = 1e-6 if parameter == "temperature" else 0
        return (
            None
            if least <= number < math.inf
            else f"{parameter} must be a cost of at least {least:g}, not {value!r}"
        )
    known = (*_WORDS, *_COSTS, *_PROBABILITIES, *_SWITCHES)
    return f"unknown parameter {parameter!r}; known are {', '.join(known)}"

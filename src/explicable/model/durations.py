"""How long steps take, from a file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from explicable.errors import InputError, PlanError, UsageError
from explicable.model.plan import parse_action
from explicable.model.problem import GroundAtom

LONGEST = 1e12  # sums of longer ones would lose the shorter ones, or overflow


@dataclass(frozen=True, slots=True)
class Durations:
    """The duration of every step, in whatever unit of time the caller means.

    Parameters
    ----------
    default
        Of steps that are not listed.
    schemas
        By the name of the action schema.
    actions
        By the whole action; goes before the schema.

    Raises
    ------
    UsageError
        If one is not above 0, or above `LONGEST`.

    Examples
    --------
    >>> durations = Durations(schemas={"move": 2.0}, actions={("move", "r1", "a", "b"): 3.0})
    >>> (
    ...     durations.of(("move", "r1", "a", "b")),
    ...     durations.of(("move", "r1", "b", "a")),
    ...     durations.of(("wait",)),
    ... )
    (3.0, 2.0, 1.0)
    """

    default: float = 1.0
    schemas: Mapping[str, float] = field(default_factory=dict)
    actions: Mapping[GroundAtom, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for duration in (self.default, *self.schemas.values(), *self.actions.values()):
            _check("a step", duration)

    def of(self, action: GroundAtom) -> float:
        """Return how long an action takes."""
        if action in self.actions:
            return self.actions[action]
        return self.schemas.get(action[0] if action else "", self.default)


def read_durations(path: str | Path) -> Durations:
    r"""Read durations from a TOML file: ``default``, ``[schemas]`` and ``[actions]``, all of them optional.

    Raises
    ------
    InputError
        If the file is no TOML in UTF-8, has anything else in it, or a duration is no number above 0.

    Examples
    --------
    >>> import tempfile
    >>> text = 'default = 2\n[schemas]\nmove = 0.5\n[actions]\n"(move r1 a b)" = 1.5\n'
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "durations.toml").write_text(text)
    ...     read_durations(Path(folder) / "durations.toml").of(("move", "r1", "a", "b"))
    1.5
    """
    import tomllib

    try:
        data = tomllib.loads(Path(path).read_bytes().decode("utf-8-sig").replace("\r\n", "\n"))
    except UnicodeDecodeError as error:
        raise InputError(f"not a text file in UTF-8 ({error.reason})", path=path) from error
    except (ValueError, RecursionError) as error:  # a ValueError also for a number of thousands of digits
        raise InputError(f"no TOML: {error}", path=path) from error
    unknown = data.keys() - {"default", "schemas", "actions"}
    if unknown:
        raise InputError(f"unknown key {min(unknown)!r}", path=path)
    try:
        return Durations(
            _number("default", data.get("default", 1.0)),
            {name.lower(): value for name, value in _numbers("schemas", data).items()},
            {parse_action(name): value for name, value in _numbers("actions", data).items()},
        )
    except (UsageError, PlanError) as error:
        raise InputError(str(error), path=path) from error


def _numbers(table: str, data: dict[str, Any]) -> dict[str, float]:
    values = data.get(table, {})
    if not isinstance(values, dict):
        raise UsageError(f"[{table}] must be a table")
    return {name: _number(name, value) for name, value in values.items()}


def _number(name: str, value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise UsageError(f"the duration of {name} must be a number, not {value!r}")
    return float(_check(name, value))


def _check(name: str, duration: float) -> float:
    if not 0 < duration <= LONGEST:
        shown = duration if isinstance(duration, float) or duration <= 0 else "more"
        raise UsageError(
            f"the duration of {name} must be finite, above 0 and at most {LONGEST:g}, not {shown}"
        )
    return duration

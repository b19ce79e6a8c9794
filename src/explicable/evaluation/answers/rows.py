"""Rows of records, and what is counted in them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from explicable.evaluation.experiments import Experiment
from explicable.evaluation.records import Record
from explicable.evaluation.statistics import Counts, Effect, Estimate, estimate
from explicable.evaluation.trials import default_settings

Row = dict[str, Any]
"""A row of a record, with the ``cell`` and ``repeat`` that it belongs to."""


def flatten(experiment: Experiment, records: Iterable[Record]) -> list[Row]:
    r"""List the rows of records; ``cell`` names what varies between the experiment's cells.

    Examples
    --------
    >>> from explicable.evaluation.experiments import parse_experiment
    >>> text = 'question = "?"\nkind = "plans"\n[[cells]]\nalpha = [0.5, 1.0]'
    >>> record = {"settings": {"alpha": 0.5}, "repeat": 3, "rows": [{"cost": 7}]}
    >>> flatten(parse_experiment(text, "e"), [record])
    [{'cost': 7, 'cell': 'alpha 0.5', 'settings': {'alpha': 0.5}, 'repeat': 3}]
    """
    default = default_settings(experiment.kind)
    cells = [{**default, **cell} for cell in experiment.cells]
    varying = [
        name
        for name in dict.fromkeys(name for cell in experiment.cells for name in cell)
        if len({repr(cell[name]) for cell in cells}) > 1
    ]
    return [
        row
        | {
            "cell": _describe({**default, **record["settings"]}, varying),
            "settings": record["settings"],
            "repeat": record["repeat"],
        }
        for record in records
        for row in record["rows"]
    ]


def group(rows: Iterable[Row], *names: str) -> dict[Any, list[Row]]:
    """Group rows by the values of one or several names, in the order of first appearance.

    Examples
    --------
    >>> group([{"plan": "ff", "cost": 3}, {"plan": "ff", "cost": 4}], "plan")
    {'ff': [{'plan': 'ff', 'cost': 3}, {'plan': 'ff', 'cost': 4}]}
    """
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        key = row[names[0]] if len(names) == 1 else tuple(row[name] for name in names)
        groups.setdefault(key, []).append(row)
    return groups


def labelled(rows: Sequence[Row], share: str, steps: str = "num_steps") -> Counts:
    """Count explicable steps as the labeller sees them: its F times the steps that count."""
    chosen = [row for row in rows if row.get(share) is not None]
    return Counts(
        [row[share] * row[steps] for row in chosen],
        [row[steps] for row in chosen],
        [problem_of(row) for row in chosen],
        [row["repeat"] for row in chosen],
    )


def judged(rows: Sequence[Row], *, all_steps: bool = True) -> Counts:
    """Count explicable steps as the participants see them who judged; human steps count as explicable."""
    part, whole, problems, people = [], [], [], []
    for row in rows:
        num_human = row["num_steps"] - row["num_robot_steps"] if all_steps else 0
        for name, explicable, asked in row.get("judged", ()):
            part.append(explicable + num_human)
            whole.append(asked + num_human)
            problems.append(problem_of(row))
            people.append((row["repeat"], name))
    return Counts(part, whole, problems, people)


def means(rows: Sequence[Row], value: Callable[[Row], float | None]) -> Estimate | None:
    """Estimate the mean of a number over rows, clustered by problem; None where no row has it."""
    found = [(value(row), problem_of(row), row["repeat"]) for row in rows]
    present = [(number, problem, repeat) for number, problem, repeat in found if number is not None]
    if not present:
        return None
    numbers, problems, repeats = zip(*present, strict=True)
    return estimate(Counts(numbers, [1.0] * len(numbers), problems, repeats))


def format_effect(effect: Effect | None) -> tuple[str, str]:
    """Write an odds ratio with its interval, and its p value; dashes where there is none.

    Examples
    --------
    >>> format_effect(Effect("ff", 0.72, 0.58, 0.9, 0.016, 180))
    ('0.72 [0.58, 0.90] (n = 180)', '0.016 (n = 180)')
    """
    if effect is None:
        return "–", "–"
    interval = f"[{effect.low:.2f}, {effect.high:.2f}]"
    return (
        f"{effect.odds_ratio:.2f} {interval} (n = {effect.num})",
        f"{effect.p_value:.2g} (n = {effect.num})",
    )


def problem_of(row: Row) -> str:
    """Name the problem that a row is about."""
    return str(row["map"])


def _describe(settings: Mapping[str, Any], varying: Sequence[str]) -> str:
    parts = [_words(name, settings[name]) for name in varying]
    return ", ".join(filter(None, parts)) or "all"


def _words(name: str, value: Any) -> str:
    """Name one setting's value; what is negative or empty is as in other cells, and not named."""
    if name in {"num_bootstrap", "num_copies"}:
        return ""  # how a model was made that the kind of its symbols names
    if name == "way":
        return f"{value} play"
    if isinstance(value, str):
        return f"judged by {value}" if name == "judges" and value else Path(value).name
    return "" if value < 0 else f"{name.removeprefix('num_').replace('_', ' ')} {value:g}"

"""Experiments as data: a TOML file each, from which the trials follow, each with its own seed.

::

    question = "Do people find explicable plans more sensible?"
    kind = "plans"                  # what a trial measures: a module of `explicable.evaluation.trials`
    seed = 1
    repeats = 10                    # trials of every cell
    settings = { num_traces = 34 }  # of all cells

    [[cells]]                       # a list stands for one cell for each of its values
    family = ["myopic", "mission"]

    [quick]                         # what a quick run does instead
    repeats = 1

Trial ``i`` of every cell has the seed ``(seed, i)``: the cells meet the same maps and participants, so that
they can be compared in pairs.
"""

import itertools
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Any, get_args

from explicable.errors import InputError, UsageError
from explicable.evaluation.records import Settings, Trial
from explicable.evaluation.trials import check_settings
from explicable.model.files import read_text

_WORDS: Mapping[str, type] = {
    "question": str,
    "kind": str,
    "seed": int,
    "repeats": int,
    "settings": dict,
    "cells": list,
    "quick": dict,
}


@dataclass(frozen=True, slots=True)
class Experiment:
    """A question, and the trials that answer it.

    Parameters
    ----------
    name
        The file's name without its ending.
    question
        In a sentence.
    kind
        What a trial measures.
    seed
        From which the trials' seeds are made.
    repeats
        Trials of each cell.
    cells
        Settings of each cell.
    """

    name: str
    question: str
    kind: str
    seed: int
    repeats: int
    cells: tuple[Settings, ...]

    def trials(self) -> list[Trial]:
        r"""List all trials, in the order in which they are done and their records stand.

        All cells come once before any comes again: a run that is broken off has all of them.

        Examples
        --------
        >>> small = parse_experiment('question = "?"\nkind = "plans"\nrepeats = 2', "small")
        >>> [trial.seed for trial in small.trials()]
        [(0, 0), (0, 1)]
        """
        return [
            Trial(self.name, self.kind, cell, repeat, (self.seed, repeat))
            for repeat in range(self.repeats)
            for cell in self.cells
        ]


def builtin_experiments(*, quick: bool = False) -> list[Experiment]:
    """Read the experiments that come with the package, in their order.

    Examples
    --------
    >>> builtin_experiments()[0].name
    'paper'
    """
    folder = resources.files("explicable.evaluation") / "experiments"
    files = sorted((file for file in folder.iterdir() if file.name.endswith(".toml")), key=lambda f: f.name)
    return [
        parse_experiment(file.read_text("utf-8"), _name(file.name), quick=quick, path=file.name)
        for file in files
    ]


def read_experiment(path: str | Path, *, quick: bool = False) -> Experiment:
    """Read one experiment from a file; see `parse_experiment`."""
    return parse_experiment(read_text(path), _name(Path(path).name), quick=quick, path=path)


def experiment_on_traces(path: str | Path, *, quick: bool = False) -> Experiment:
    """Make the paper's experiment with the traces of a study in the place of simulated participants' games.

    Raises
    ------
    InputError
        If they can't be read, or are of another domain than the paper's.
    """
    from explicable.first_response import Semantics
    from explicable.labelling import read_traces

    file = resources.files("explicable.evaluation") / "experiments" / "traces" / "study.toml"
    made = parse_experiment(file.read_text("utf-8"), "study", quick=quick, path=file.name)
    domains = {f"first-response-{semantics}": semantics for semantics in get_args(Semantics)}
    found = dict.fromkeys(domains.get(trace.problem.robot.domain.name) for trace in read_traces(path))
    if not found or None in found:
        raise InputError("the paper's experiment needs traces of the first-response domain", path=path)
    cells = [
        {**cell, "semantics": semantics, "traces": str(path)} for semantics in found for cell in made.cells
    ]
    return replace(made, cells=tuple(cells))


def parse_experiment(
    text: str, name: str, *, quick: bool = False, path: str | Path | None = None
) -> Experiment:
    r"""Read an experiment.

    Parameters
    ----------
    text
        TOML, as described above.
    name
        Of the experiment.
    quick
        Whether what stands under ``[quick]`` takes the place of what stands elsewhere.
    path
        For messages.

    Raises
    ------
    InputError
        If it is not TOML, or a name or value in it has no meaning.

    Examples
    --------
    >>> text = 'question = "?"\nkind = "plans"\n[[cells]]\nalpha = [0.5, 1.0]\nsemantics = "exclusive"'
    >>> [dict(cell) for cell in parse_experiment(text, "small").cells]
    [{'alpha': 0.5, 'semantics': 'exclusive'}, {'alpha': 1.0, 'semantics': 'exclusive'}]
    """
    try:
        content = tomllib.loads(text)
        _check_words(content, {"question", "kind"})
        short = content.get("quick", {})
        _check_words(short)
        common = dict(content.get("settings", {}))
        if quick:
            content |= {word: value for word, value in short.items() if word != "settings"}
            common |= short.get("settings", {})
        cells = tuple(cell for table in content.get("cells", [{}]) for cell in _expand(common, table))
        for cell in cells:
            check_settings(content["kind"], cell)
    except (tomllib.TOMLDecodeError, UsageError) as error:
        raise InputError(f"not an experiment: {error}", path=path) from error
    return Experiment(
        name, content["question"], content["kind"], content.get("seed", 0), content.get("repeats", 1), cells
    )


def _name(file: str) -> str:
    """Name an experiment after its file; a number at the beginning is for the order only."""
    return re.sub(r"^\d+-", "", Path(file).stem)


def _check_words(content: Mapping[str, Any], needed: Iterable[str] = ()) -> None:
    missing = sorted(set(needed) - set(content))
    if missing:
        raise UsageError(f"it does not say its {' and '.join(missing)}")
    for word, value in content.items():
        if word not in _WORDS:
            raise UsageError(f"unknown word {word!r}; known are {', '.join(_WORDS)}")
        if not isinstance(value, _WORDS[word]) or isinstance(value, bool):
            raise UsageError(f"{word} can't be {value!r}")
    if content.get("repeats", 1) < 1 or content.get("seed", 0) < 0:
        raise UsageError("repeats must be at least 1, the seed at least 0")
    if not all(isinstance(table, dict) for table in content.get("cells", [])):
        raise UsageError("cells are tables: [[cells]]")


def _expand(common: Settings, table: Settings) -> Iterator[Settings]:
    """Yield one cell for each combination of the values that are listed in a table."""
    choices = [value if isinstance(value, list) else [value] for value in table.values()]
    for values in itertools.product(*choices):
        yield {**common, **dict(zip(table, values, strict=True))}

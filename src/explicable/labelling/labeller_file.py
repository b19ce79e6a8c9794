"""Labeller files: JSON with a checksum over the content (docs/labelling.md)."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, get_args

from explicable.errors import LabellerError, UsageError
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.learning import CLASSES, Symbols
from explicable.labelling.templates import TEMPLATES_VERSION
from explicable.model.files import write_whole
from explicable.model.strict_json import parse_json

if TYPE_CHECKING:
    from collections.abc import Sequence

FORMAT = "explicable-labeller"
VERSION = 2
LABELS = ("explicable", "inexplicable")
EMPTY_LABEL = "inexplicable"
MAX_WEIGHT = 1e6
"""Largest weight of a feature: the core takes sums of up to 1e9, and no step has a thousand features."""
MAX_TRANSITION = 300.0
"""Largest weight of a transition, whose exponential the path scorer keeps."""

_KEYS = frozenset(
    (
        "format",
        "version",
        "templates",
        "symbols",
        "labels",
        "task_labels",
        "empty_label",
        "schemas",
        "features",
        "model",
        "bootstrap",
        "task_model",
        "training",
        "sha256",
    )
)


@dataclass(frozen=True, slots=True)
class LabellerContent:
    """What a labeller file holds: the parameters of `explicable.labelling.labeller.Labeller`."""

    model: ConditionalRandomField
    bootstrap: tuple[ConditionalRandomField, ...]
    schemas: tuple[str, ...]
    summary: Mapping[str, Any]
    symbols: Symbols = "lifted"
    task_model: ConditionalRandomField | None = None


def write_labeller(path: str | Path, labeller: LabellerContent) -> None:
    """Write a labeller file, whole or not at all.

    Raises
    ------
    UsageError
        If the bootstrap's models have other features than the model.
    """
    names = labeller.model.feature_names_
    task_model = labeller.task_model
    others = (*labeller.bootstrap, *([task_model] if task_model else []))
    if any(model.feature_names_ != names for model in others):
        raise UsageError("the models of the bootstrap or of tasks have other features than the model itself")
    content = {
        "format": FORMAT,
        "version": VERSION,
        "templates": TEMPLATES_VERSION,
        "symbols": labeller.symbols,
        "labels": list(LABELS),
        "task_labels": list(task_model.classes_[1:-1]) if task_model else [],
        "empty_label": EMPTY_LABEL,
        "schemas": list(labeller.schemas),
        "features": list(names),
        "model": _weights(labeller.model),
        "bootstrap": [_weights(model) for model in labeller.bootstrap],
        "task_model": _weights(task_model) if task_model else None,
        "training": dict(labeller.summary),
    }
    write_whole(path, json.dumps(content | {"sha256": checksum(content)}, allow_nan=False) + "\n")


def checksum(content: dict[str, Any]) -> str:
    """Return the SHA-256 of a labeller's content, written as JSON with sorted keys and without spaces.

    Examples
    --------
    >>> checksum({"b": 1, "a": [2.5]})[:8]
    '11cf7051'
    """
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def read_labeller(path: str | Path) -> LabellerContent:
    """Read a labeller file.

    Raises
    ------
    LabellerError
        If it is damaged, of another version, or no labeller at all.
    """
    return _Reader(Path(path)).read()


def _weights(model: ConditionalRandomField) -> dict[str, Any]:
    return {"weights": model.state_weights_.tolist(), "transitions": model.transition_weights_.tolist()}


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path = path

    def refuse(self, message: str) -> NoReturn:
        raise LabellerError(message, path=self.path)

    def read(self) -> LabellerContent:
        content = self.decode()
        if not isinstance(content, dict) or content.get("format") != FORMAT:
            self.refuse("not a labeller file")
        for key, version in (("version", VERSION), ("templates", TEMPLATES_VERSION)):
            if content.get(key) != version or isinstance(content[key], bool):
                self.refuse(f"a labeller with {key} {content.get(key)!r} can't be read, only with {version}")
        missing, unknown = _KEYS - content.keys(), content.keys() - _KEYS
        if missing or unknown:
            self.refuse(f"damaged: {'no' if missing else 'unknown'} key {min(missing or unknown)!r}")
        if content.pop("sha256") != checksum(content):
            self.refuse("damaged: the content does not agree with its SHA-256")
        if content["labels"] != list(LABELS) or content["empty_label"] != EMPTY_LABEL:
            self.refuse(f"labels must be {', '.join(LABELS)}, of which {EMPTY_LABEL} is the empty one")
        if not isinstance(content["training"], dict) or not isinstance(content["bootstrap"], list):
            self.refuse("damaged: 'training' must be an object, 'bootstrap' a list")
        if content["symbols"] not in get_args(Symbols):
            self.refuse(f"symbols must be {' or '.join(get_args(Symbols))}")
        names = self.names("features", content["features"])
        tasks = self.names("task_labels", content["task_labels"])
        if bool(tasks) != (content["task_model"] is not None):
            self.refuse("damaged: 'task_labels' without 'task_model', or the other way round")
        return LabellerContent(
            self.model(names, content["model"], CLASSES),
            tuple(self.model(names, model, CLASSES) for model in content["bootstrap"]),
            tuple(self.names("schemas", content["schemas"])),
            content["training"],
            content["symbols"],
            self.model(names, content["task_model"], (True, *tasks, False)) if tasks else None,
        )

    def decode(self) -> object:
        try:
            return parse_json(self.path.read_bytes().decode("utf-8-sig"))
        except json.JSONDecodeError as error:
            raise LabellerError(
                f"not a labeller file: not JSON: {error.msg}",
                path=self.path,
                line=error.lineno,
                column=error.colno,
            ) from error
        except (ValueError, RecursionError) as error:
            self.refuse(f"not a labeller file: {error}")

    def names(self, what: str, data: object) -> list[str]:
        if not isinstance(data, list) or not all(isinstance(name, str) for name in data):
            self.refuse(f"damaged: {what!r} must be a list of names")
        return data

    def model(
        self, names: "Sequence[str]", data: object, classes: "Sequence[bool | str]"
    ) -> ConditionalRandomField:
        if not isinstance(data, dict) or data.keys() != {"weights", "transitions"}:
            self.refuse("damaged: a model must have 'weights' and 'transitions'")
        weights = self.matrix("weights", data["weights"], (len(names), len(classes)), MAX_WEIGHT)
        shape = (len(classes), len(classes))
        transitions = self.matrix("transitions", data["transitions"], shape, MAX_TRANSITION)
        try:
            return ConditionalRandomField.from_weights(classes, names, weights, transitions)
        except UsageError as error:
            self.refuse(f"damaged: {error}")

    def matrix(self, what: str, data: object, shape: tuple[int, int], limit: float) -> list[list[float]]:
        num_rows, num_columns = shape
        if not isinstance(data, list) or len(data) != num_rows:
            self.refuse(f"damaged: {what!r} must have {num_rows} rows")
        for row in data:
            if (
                not isinstance(row, list)
                or len(row) != num_columns
                or not all(_is_weight(weight, limit) for weight in row)
            ):
                self.refuse(f"damaged: a row of {what!r} must hold {num_columns} numbers within +-{limit:g}")
        return data


def _is_weight(value: object, limit: float) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= limit

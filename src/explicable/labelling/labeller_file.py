"""Labeller files: JSON with a checksum over the content (docs/labelling.md)."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from explicable.errors import LabellerError, UsageError
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.learning import CLASSES
from explicable.labelling.templates import TEMPLATES_VERSION
from explicable.model.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence

FORMAT = "explicable-labeller"
VERSION = 1
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
        "labels",
        "empty_label",
        "schemas",
        "features",
        "model",
        "bootstrap",
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


def write_labeller(path: str | Path, labeller: LabellerContent) -> None:
    """Write a labeller file, whole or not at all.

    Raises
    ------
    UsageError
        If the bootstrap's models have other features than the model.
    """
    names = labeller.model.feature_names_
    if any(model.feature_names_ != names for model in labeller.bootstrap):
        raise UsageError("the models of the bootstrap have other features than the model itself")
    content = {
        "format": FORMAT,
        "version": VERSION,
        "templates": TEMPLATES_VERSION,
        "labels": list(LABELS),
        "empty_label": EMPTY_LABEL,
        "schemas": list(labeller.schemas),
        "features": list(names),
        "model": _weights(labeller.model),
        "bootstrap": [_weights(model) for model in labeller.bootstrap],
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
        names = self.names("features", content["features"])
        return LabellerContent(
            self.model(names, content["model"]),
            tuple(self.model(names, model) for model in content["bootstrap"]),
            tuple(self.names("schemas", content["schemas"])),
            content["training"],
        )

    def decode(self) -> object:
        try:
            data: object = json.loads(
                self.path.read_bytes().decode("utf-8-sig"), parse_constant=_refuse_constant
            )
        except json.JSONDecodeError as error:
            raise LabellerError(
                f"not a labeller file: not JSON: {error.msg}",
                path=self.path,
                line=error.lineno,
                column=error.colno,
            ) from error
        except (ValueError, RecursionError) as error:
            self.refuse(f"not a labeller file: {error}")
        return data

    def names(self, what: str, data: object) -> list[str]:
        if not isinstance(data, list) or not all(isinstance(name, str) for name in data):
            self.refuse(f"damaged: {what!r} must be a list of names")
        return data

    def model(self, names: "Sequence[str]", data: object) -> ConditionalRandomField:
        if not isinstance(data, dict) or data.keys() != {"weights", "transitions"}:
            self.refuse("damaged: a model must have 'weights' and 'transitions'")
        weights = self.matrix("weights", data["weights"], len(names), MAX_WEIGHT)
        transitions = self.matrix("transitions", data["transitions"], len(CLASSES), MAX_TRANSITION)
        try:
            return ConditionalRandomField.from_weights(CLASSES, names, weights, transitions)
        except UsageError as error:
            self.refuse(f"damaged: {error}")

    def matrix(self, what: str, data: object, num_rows: int, limit: float) -> list[list[float]]:
        if not isinstance(data, list) or len(data) != num_rows:
            self.refuse(f"damaged: {what!r} must have {num_rows} rows")
        for row in data:
            if (
                not isinstance(row, list)
                or len(row) != len(CLASSES)
                or not all(_is_weight(weight, limit) for weight in row)
            ):
                self.refuse(f"damaged: a row of {what!r} must hold {len(CLASSES)} numbers within +-{limit:g}")
        return data


def _is_weight(value: object, limit: float) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= limit


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no JSON number")

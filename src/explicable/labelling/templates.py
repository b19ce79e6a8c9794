"""The templates of lifted features: their names, values, and what they tell a person (docs/labelling.md)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

TEMPLATES_VERSION = 1

PROGRESS = (
    "no-target",
    "unconcerned",
    "nearer",
    "no-nearer",
    "farther",
    "much-farther",
    "no-way",
    "shortcut",
    "done",
    "done-other",
)
"""How a step changes the distance to a target; the order is that of the compiled core."""

NOTHING = "-"  # no name in PDDL
BESIDE = (*PROGRESS, "human-step", NOTHING)
"""What may stand beside a step: a robot's step by its progress toward the request, a human's, or nothing."""

MAX_ARGUMENTS = 8
"""Further arguments of an action are not compared."""

UNFAMILIAR = "unfamiliar:"  # no name in PDDL
"""In the place of each feature that no trace showed, of those templates that say something of every step."""

Kind = Literal["schema", "neighbour", "argument", "progress", "beside"]


@dataclass(frozen=True, slots=True)
class Template:
    """A family of features.

    Attributes
    ----------
    name
    kinds
        Of its values.
    text
        How to tell it to a person.
    is_optional
        Whether it may say nothing of a robot's step; of others, each step has exactly one feature.
    """

    name: str
    kinds: tuple[Kind, ...]
    text: str
    is_optional: bool = False

    def feature(self, *values: object) -> str:
        """Name one feature of the family.

        Examples
        --------
        >>> TEMPLATES["after"].feature("move", "command")
        'after: move command'
        """
        return f"{self.name}: {' '.join(map(str, values))}"


_TEMPLATES = (
    Template("step", ("schema",), "it is a {}"),
    Template("after", ("schema", "neighbour"), "it is a {} after {}"),
    Template("before", ("schema", "neighbour"), "it is a {} before {}"),
    Template(
        "same-after",
        ("schema", "schema", "argument", "argument"),
        "of the {0}, argument {2} is argument {3} of the {1} before it",
        is_optional=True,
    ),
    Template(
        "same-before",
        ("schema", "schema", "argument", "argument"),
        "of the {0}, argument {2} is argument {3} of the {1} after it",
        is_optional=True,
    ),
    Template(
        "same-human",
        ("schema", "schema", "argument", "argument"),
        "of the {0}, argument {2} is argument {3} of the person's last {1}",
        is_optional=True,
    ),
    Template("undoes", ("schema",), "the {} undoes the robots' step before", is_optional=True),
    Template("returns", ("schema",), "the {} undoes a recent step of the robots", is_optional=True),
    Template("unbelieved", ("schema",), "the person believes that this {} is impossible", is_optional=True),
    Template("request", ("schema", "progress"), "{}, as the person sees the request: {}"),
    Template("request-own", ("schema", "progress"), "{}, as the robot sees the request: {}"),
    Template("goal", ("schema", "progress"), "{}, as the person sees the nearest goal: {}"),
    Template("goal-own", ("schema", "progress"), "{}, as the robot sees the nearest goal: {}"),
    Template("mission", ("schema", "progress"), "{}, as the person sees the whole mission: {}"),
    Template("models", ("progress", "progress"), "request as the person sees it: {}; as the robot does: {}"),
    Template("request-mission", ("progress", "progress"), "request: {}; whole mission: {} (person's view)"),
    Template("trend", ("progress", "beside"), "request: {}; at the step before: {}"),
    Template("outlook", ("progress", "beside"), "request: {}; at the step after: {}"),
)

TEMPLATES = {template.name: template for template in _TEMPLATES}
"""All templates by name, in the order that the compiled core knows them by."""


_PROGRESS_NUMBERS = {name: number for number, name in enumerate(PROGRESS)}
_BESIDE_NUMBERS = {name: number for number, name in enumerate(BESIDE)}


def explain_feature(feature: str) -> str:
    """Tell what a feature means.

    Examples
    --------
    >>> explain_feature("request: move farther")
    'move, as the person sees the request: farther'
    """
    if feature == UNFAMILIAR:
        return "no trace showed the like"
    name, _, values = feature.partition(": ")
    template = TEMPLATES.get(name)
    if template is None:
        return feature
    return template.text.format(*("nothing" if value == NOTHING else value for value in values.split(" ")))


FeatureCode = tuple[int, tuple[int, int, int, int]]
"""Number of a feature's template and those of its values, as the compiled core knows them."""


def feature_code(feature: str, schemas: Mapping[str, int], max_arity: int) -> FeatureCode | None:
    """Return the number of a feature's template and those of its values, as the compiled core knows them.

    Parameters
    ----------
    feature
        Its name.
    schemas
        Number of each action schema of the task.
    max_arity
        Most parameters that a schema of the task has.

    Returns
    -------
    (template, values), or None if the feature can't occur in the task.

    Examples
    --------
    >>> feature_code("after: move -", {"command": 0, "move": 1}, max_arity=3)
    (1, (1, 2, 0, 0))
    """
    name, _, text = feature.partition(": ")
    template, values = TEMPLATES.get(name), text.split(" ")
    if template is None or len(values) != len(template.kinds):
        return None
    numbers = {
        "schema": schemas,
        "neighbour": {**schemas, NOTHING: len(schemas)},
        "argument": {str(place): place - 1 for place in range(1, min(max_arity, MAX_ARGUMENTS) + 1)},
        "progress": _PROGRESS_NUMBERS,
        "beside": _BESIDE_NUMBERS,
    }
    code = [numbers[kind].get(value) for kind, value in zip(template.kinds, values, strict=True)]
    if None in code:
        return None
    padded = (*(number for number in code if number is not None), 0, 0, 0, 0)
    return list(TEMPLATES).index(name), (padded[0], padded[1], padded[2], padded[3])

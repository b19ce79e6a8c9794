"""The plain text format of sequence labelling toolkits: one step a line, features first, its label last."""

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from explicable.errors import PlanError, TraceError, UsageError
from explicable.labelling.records import NO_TASKS, LabelledStep, Origin, Trace
from explicable.model.plan import parse_action
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem

UNOBSERVED = "?"


def read_feature_sequences(
    path: str | Path,
) -> tuple[list[list[tuple[str, ...]]], list[list[str | None]]]:
    r"""Read sequences of features: one step a line, its label last; a blank line ends a sequence.

    Words are separated by blanks or tabs. The label ``?`` says that nobody was asked.

    Returns
    -------
    features, labels
        Of each step of each sequence, ready for `ConditionalRandomField.fit`.

    Raises
    ------
    TraceError
        If the file is not UTF-8.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "steps.txt").write_text("move near yes\nmove far no\n\nvisit ?\n")
    ...     read_feature_sequences(Path(folder) / "steps.txt")
    ([[('move', 'near'), ('move', 'far')], [('visit',)]], [['yes', 'no'], [None]])
    """
    features: list[list[tuple[str, ...]]] = []
    labels: list[list[str | None]] = []
    for sequence in _sequences(path):
        features.append([tuple(words[:-1]) for _, words in sequence])
        labels.append([None if words[-1] == UNOBSERVED else words[-1] for _, words in sequence])
    return features, labels


def read_plain_traces(
    path: str | Path,
    problem: TeamProblem,
    *,
    annotator: str,
    origin: Origin = "person",
    explicable: str = "true",
    inexplicable: str = "false",
) -> list[Trace]:
    r"""Read traces of one problem whose features are the ground symbols of each step.

    A line holds the action schema, its objects, and the label: ``move r1 a b true``. Parentheses around the
    step are allowed, upper case is not told from lower.

    Parameters
    ----------
    path
        Text file, one step a line, a blank line between traces.
    problem
        What the team did.
    annotator, origin
        Who gave the labels.
    explicable, inexplicable
        The labels that say so. ``?``: nobody was asked. Any other label names the task that the step serves,
        and is explicable.

    Raises
    ------
    TraceError
        If the file is not UTF-8, holds no step, or a line has no step, an action or a number of objects that
        the domain does not have, or a label that can't be a task's name; says which line. Whether steps are
        applicable is left to `check_traces`.

    Examples
    --------
    >>> import tempfile
    >>> from explicable.first_response import World, encode
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "steps.txt").write_text("command person c-0-1 ?\nmove r1 c-0-0 c-0-1 yes\n")
    ...     (trace,) = read_plain_traces(
    ...         Path(folder) / "steps.txt", encode(World(("@*",))), annotator="anna", explicable="yes"
    ...     )
    >>> [(step.agent, step.action[0], step.label) for step in trace.steps]
    [('person', 'command', None), ('r1', 'move', True)]
    """
    known: dict[str, bool | None] = {UNOBSERVED: None, explicable: True, inexplicable: False}
    if len(known) < 3:
        raise UsageError("the labels for explicable, inexplicable and not asked must differ")
    num_parameters = {schema.name: len(schema.parameters) for schema in problem.composite.domain.actions}
    traces = []
    for sequence in _sequences(path):
        steps = []
        for line, (*words, label) in sequence:
            try:
                action = parse_action(f"({' '.join(words).strip('()')})")
            except PlanError as error:
                found = " ".join([*words, label])
                message = f"expected one step and its label, such as move r1 a b true; found {found!r}"
                raise TraceError(message, path=path, line=line) from error
            if label not in known and label.lower() in NO_TASKS:
                message = (
                    f"{label!r} can't be a task's name: say which labels mean explicable and inexplicable"
                )
                raise TraceError(message, path=path, line=line)
            if objection := _objection(action, label, num_parameters):
                raise TraceError(objection, path=path, line=line)
            steps.append(LabelledStep(problem.agent_of(action).name, action, known.get(label, label)))
        traces.append(Trace(problem, tuple(steps), annotator, origin))
    if not traces:
        raise TraceError("there is no step in it", path=path)
    return traces


def _objection(action: GroundAtom, label: str, num_parameters: dict[str, int]) -> str | None:
    """Say why a line can't be a step of the domain."""
    name, *objects = action
    if name not in num_parameters:
        known = ", ".join(sorted(num_parameters))
        return f"{name!r} is no action of the domain; those are {known}"
    if len(objects) != num_parameters[name]:
        return (
            f"{name} takes {num_parameters[name]} objects, found {len(objects)}"
            f" (the last word, {label!r}, is taken for the label)"
        )
    return None


def _sequences(path: str | Path) -> Iterator[list[tuple[int, list[str]]]]:
    """Yield the lines of each sequence: their numbers and words."""
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise TraceError(f"not a text file in UTF-8 ({error.reason})", path=path) from error
    numbered = ((number, line.split()) for number, line in enumerate(text.split("\n"), start=1))
    for has_words, lines in groupby(numbered, key=lambda line: bool(line[1])):
        if has_words:
            yield list(lines)

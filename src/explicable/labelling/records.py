"""One line of a trace file: its values, its reader and its writer (docs/labelling.md)."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any, Literal, NoReturn

from explicable.errors import PDDLError, PlanError, TraceError
from explicable.model.plan import format_action, parse_action
from explicable.model.problem import GroundAtom, Problem
from explicable.model.strict_json import parse_json
from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem

FORMAT = "explicable-trace"
VERSION = 1

Origin = Literal["person", "simulated"]

NO_TASKS = frozenset(
    ("", "?", "-", "true", "false", "null", "none", "yes", "no", "explicable", "inexplicable")
)
"""Texts that don't name a task: whoever writes them means something else."""

PARTS = ("domain", "problem", "human_domain", "human_problem")
_TEXTS = ("semantics", "name", "started")
_KEYS = frozenset(("format", "version", "problem", "steps", "annotator", "origin", "notes", *_TEXTS))
_STEP_KEYS = frozenset(("agent", "operator", "label", "time"))


@dataclass(frozen=True, slots=True)
class LabelledStep:
    """A step and what the annotator said of it.

    Parameters
    ----------
    agent
        Who executed it.
    action
        ``(schema, object, ...)``.
    label
        True: explicable; False: inexplicable; None: not asked. Text: explicable, as part of the task of this
        name.
    time
        Seconds since the trace was started.
    """

    agent: str
    action: GroundAtom
    label: bool | str | None = None
    time: float | None = None

    @property
    def is_explicable(self) -> bool | None:
        """What the label says of two kinds of steps: a task's name counts as explicable."""
        return None if self.label is None else self.label is not False

    def find_wrong_agent(self, problem: TeamProblem) -> str | None:
        """Say what is wrong if the action belongs to somebody else.

        Raises
        ------
        PDDLError
            If the problem does not say who acts; see `TeamProblem.agents`.
        """
        owner = problem.agent_of(self.action).name
        shown = format_action(self.action)
        return None if owner == self.agent else f"{shown} belongs to {owner}, not to {self.agent}"


@dataclass(frozen=True, slots=True)
class Trace:
    """One executed joint plan with its labels.

    Parameters
    ----------
    problem
        What the team was to do.
    steps
        In the order of execution.
    annotator
        Who gave the labels.
    origin
        Whether the annotator is a person or a simulated participant.
    semantics, name
        Of the task, where it has one; free text.
    started
        Date and time, ISO 8601.
    notes
        Anything else that JSON can hold.
    """

    problem: TeamProblem
    steps: tuple[LabelledStep, ...]
    annotator: str
    origin: Origin
    semantics: str | None = None
    name: str | None = None
    started: str | None = None
    notes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def actions(self) -> tuple[GroundAtom, ...]:
        """The steps' actions."""
        return tuple(step.action for step in self.steps)


def format_record(trace: Trace, texts: Mapping[str, str]) -> str:
    """Write a trace as one line of JSON; ``texts`` is its problem as PDDL."""
    record: dict[str, Any] = {"format": FORMAT, "version": VERSION}
    record.update({key: getattr(trace, key) for key in _TEXTS if getattr(trace, key) is not None})
    record.update(annotator=trace.annotator, origin=trace.origin, problem=dict(texts))
    record["steps"] = [
        {"agent": step.agent, "operator": format_action(step.action), "label": step.label}
        | ({} if step.time is None else {"time": step.time})
        for step in trace.steps
    ]
    if trace.notes:
        record["notes"] = dict(trace.notes)
    return json.dumps(record, allow_nan=False)


class RecordReader:
    """One line of a trace file on its way to a `Trace`; every failure names path and line."""

    def __init__(self, path: Path, line: int, problems: dict[tuple[str, ...], TeamProblem]) -> None:
        self.path = path
        self.line = line
        self.problems = problems

    def _refuse(self, message: str) -> NoReturn:
        raise TraceError(message, path=self.path, line=self.line)

    def read(self, line: bytes) -> Trace:
        """Return the trace on a line.

        Raises
        ------
        TraceError
            If it is not one of this version.
        """
        data = self._decode(line)
        if not isinstance(data, dict) or data.get("format") != FORMAT:
            self._refuse(f'not a trace: expected an object with "format": "{FORMAT}"')
        if data.get("version") != VERSION or isinstance(data["version"], bool):
            self._refuse(f"can't read traces of version {data.get('version')!r}, only of version {VERSION}")
        self._check_keys("the trace", data, _KEYS, required=("problem", "steps", "annotator", "origin"))
        if data["origin"] not in ("person", "simulated"):
            self._refuse(f'origin must be "person" or "simulated", not {_show(data["origin"])}')
        steps, notes = data["steps"], data.get("notes", {})
        if not isinstance(steps, list):
            self._refuse("steps must be a list")
        if not isinstance(notes, dict):
            self._refuse("notes must be an object")
        if data.get("started") is not None:
            self._check_moment(self._text("started", data["started"]))
        problem = self._read_problem(data["problem"])
        return Trace(
            problem=problem,
            steps=tuple(self._read_step(number, step, problem) for number, step in enumerate(steps, start=1)),
            annotator=self._text("annotator", data["annotator"]),
            origin=data["origin"],
            notes=notes,
            **{key: None if data.get(key) is None else self._text(key, data[key]) for key in _TEXTS},
        )

    def _check_moment(self, text: str) -> None:
        try:
            datetime.fromisoformat(text)
        except ValueError:
            self._refuse(f"started must be a date and time in ISO 8601, not {_show(text)}")

    def _decode(self, line: bytes) -> object:
        try:
            return parse_json(line.decode("utf-8"))
        except json.JSONDecodeError as error:
            raise TraceError(
                f"not JSON: {error.msg}", path=self.path, line=self.line, column=error.colno
            ) from error
        except (ValueError, RecursionError) as error:
            raise TraceError(f"not JSON: {error}", path=self.path, line=self.line) from error

    def _check_keys(
        self, what: str, data: dict[str, Any], known: Iterable[str], required: tuple[str, ...]
    ) -> None:
        for key in required:
            if key not in data:
                self._refuse(f"{what} has no {key!r}")
        unknown = data.keys() - set(known)
        if unknown:
            self._refuse(f"{what} has the unknown key {_show(min(unknown))}")

    def _text(self, what: str, value: object) -> str:
        if not isinstance(value, str) or not value:
            self._refuse(f"{what} must be text, not {_show(value)}")
        return value

    def _read_step(self, number: int, data: object, problem: TeamProblem) -> LabelledStep:
        what = f"step {number}"
        if not isinstance(data, dict):
            self._refuse(f"{what} must be an object, not {_show(data)}")
        self._check_keys(what, data, _STEP_KEYS, required=("agent", "operator", "label"))
        label, time = data["label"], data.get("time")
        is_name = isinstance(label, str) and label.strip().lower() not in NO_TASKS
        if label is not None and not isinstance(label, bool) and not is_name:
            self._refuse(f"{what}: label must be true, false or null, or name a task; not {_show(label)}")
        if time is not None:
            if isinstance(time, bool) or not isinstance(time, int | float) or not abs(time) <= 1e15:
                self._refuse(f"{what}: time must be a number of seconds, not {_show(time)}")
            time = float(time)
        try:
            action = parse_action(self._text(f"{what}: operator", data["operator"]))
        except PlanError as error:
            self._refuse(f"{what}: {error.message}")
        step = LabelledStep(self._text(f"{what}: agent", data["agent"]).lower(), action, label, time)
        try:
            fault = step.find_wrong_agent(problem)
        except PDDLError as error:
            self._refuse(f"problem: {error}")
        if fault:
            self._refuse(f"{what}: {fault}")
        return step

    def _read_problem(self, data: object) -> TeamProblem:
        if not isinstance(data, dict):
            self._refuse(f"problem must be an object, not {_show(data)}")
        self._check_keys("problem", data, PARTS, required=("domain", "problem"))
        if ("human_domain" in data) and ("human_problem" not in data):
            self._refuse("problem has a 'human_domain' but no 'human_problem'")
        texts = tuple(self._pddl(part, data[part]) if part in data else "" for part in PARTS)
        if texts not in self.problems:
            domain, problem, human_domain, human_problem = texts
            robot = self._parse(domain, problem, "")
            human = self._parse(human_domain or domain, human_problem, "human_") if human_problem else None
            self.problems[texts] = TeamProblem(robot=robot, human=human)
        return self.problems[texts]

    def _pddl(self, part: str, source: object) -> str:
        if isinstance(source, str):
            return source
        if not isinstance(source, dict) or source.keys() != {"file", "sha256"}:
            self._refuse(f'{part} must be PDDL text, or {{"file": ..., "sha256": ...}}')
        name = Path(self._text(f"{part}: file", source["file"]))
        if name.is_absolute() or ".." in name.parts or "\0" in str(name):
            self._refuse(f"{part}: the file must lie beside the trace file or below it, not at {name}")
        try:
            content = (self.path.parent / name).read_bytes()
            if hashlib.sha256(content).hexdigest() != str(source["sha256"]).lower():
                self._refuse(f"{part}: {name} has changed: its SHA-256 differs from the one recorded")
            return content.decode("utf-8-sig")
        except OSError as error:
            self._refuse(f"{part}: {name} can't be read: {error.strerror}")
        except UnicodeDecodeError:
            self._refuse(f"{part}: {name} is not UTF-8")

    def _parse(self, domain: str, problem: str, prefix: str) -> Problem:
        part = f"{prefix}domain"
        try:
            parsed = parse_domain(domain)
            part = f"{prefix}problem"
            return parse_problem(problem, parsed)
        except PDDLError as error:
            place = "".join(f", line {error.line}" for _ in range(error.line is not None))
            self._refuse(f"{part}{place}: {error.message}")


def _show(value: object) -> str:
    shown = repr(value)
    return shown if len(shown) <= 60 else f"{shown[:57]}..."

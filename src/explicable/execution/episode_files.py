"""Files of games on record: JSON Lines (docs/execution.md).

The first line says what was played and how it ended, and holds the game's trace; then one line an event.
"""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NoReturn

from explicable.errors import EpisodeError, PlanError, TraceError
from explicable.execution.monitor import Event, State
from explicable.execution.notices import Notice
from explicable.execution.records import EpisodeRecord, RecordedEvent
from explicable.execution.robots.protocol import Fact
from explicable.labelling.records import RecordReader, format_record
from explicable.labelling.traces import problem_texts
from explicable.model.files import write_whole
from explicable.model.plan import format_action, parse_action
from explicable.model.problem import GroundAtom
from explicable.model.strict_json import parse_json

FORMAT = "explicable-episode"
VERSION = 1

_HEADER = frozenset(
    ("format", "version", "trace", "observable", "map", "deviations", "changes", "planning_s", "at_once")
)
_LINE = frozenset(
    ("time", "event", "state", "action", "facts", "answer", "plan", "agent", "reason", "refusal", "digest")
)


def write_episode(path: str | Path, recorded: EpisodeRecord) -> None:
    """Write a record, whole or not at all; `read_episode` restores it exactly."""
    header = {
        "format": FORMAT,
        "version": VERSION,
        "trace": json.loads(format_record(recorded.trace, problem_texts(recorded.trace.problem))),
        "observable": [format_action(atom) for atom in recorded.observable],
        **({} if recorded.map_text is None else {"map": recorded.map_text}),
        "deviations": recorded.num_deviations,
        "changes": recorded.num_changes,
        "planning_s": list(recorded.planning_s),
        **({"at_once": True} if recorded.at_once else {}),
    }
    lines = (header, *map(_format_event, recorded.events))
    write_whole(path, "".join(json.dumps(line, allow_nan=False) + "\n" for line in lines))


def _format_event(event: RecordedEvent) -> dict[str, Any]:
    notice = event.notice
    optional = {
        "action": format_action(notice.action) if notice.action else "",
        "facts": [str(fact) for fact in notice.facts],
        "answer": notice.answer,
        "plan": [format_action(action) for action in notice.plan],
        "agent": notice.agent,
        "reason": notice.reason,
        "refusal": event.refusal,
        "digest": event.digest,
    }
    given = {key: value for key, value in optional.items() if value not in ("", [], None)}
    return {"time": event.time_s, "event": notice.event.value, "state": event.state.value, **given}


def read_episode(path: str | Path) -> EpisodeRecord:
    """Read a record.

    Raises
    ------
    EpisodeError
        If it is none of this version; says which line and why. Whether its events can have led to what it
        says, `replay` tells.
    """
    path = Path(path)
    lines = [line for line in path.read_bytes().split(b"\n") if line.strip()]
    header = _Line(path, 1, lines[0] if lines else b"null")
    data = header.data
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        header.refuse(f'not an episode: expected an object with "format": "{FORMAT}"')
    if type(data.get("version")) is not int or data["version"] != VERSION:
        header.refuse(f"can't read episodes of version {data.get('version')!r}, only of version {VERSION}")
    header.check_keys(_HEADER, required=_HEADER - {"map", "at_once"})
    try:
        trace = RecordReader(path, 1, {}).read(json.dumps(data["trace"]).encode())
    except TraceError as error:
        header.refuse(f"trace: {error.message}")
    return EpisodeRecord(
        trace,
        tuple(_Line(path, number, line).event() for number, line in enumerate(lines[1:], start=2)),
        tuple(header.action("observable", text) for text in header.list_of_texts("observable")),
        header.text("map") if "map" in data else None,
        header.count("deviations"),
        header.count("changes"),
        tuple(header.number("planning_s", value) for value in header.items("planning_s")),
        header.truth("at_once"),
    )


class _Line:
    """One line of a record; every failure names file and line."""

    def __init__(self, path: Path, number: int, line: bytes) -> None:
        self.path, self.line_number = path, number
        try:
            self.data: Any = parse_json(line.decode("utf-8"))
        except (ValueError, RecursionError) as error:
            self.refuse(f"not JSON: {error}")

    def refuse(self, message: str) -> NoReturn:
        raise EpisodeError(message, path=self.path, line=self.line_number)

    def check_keys(self, known: frozenset[str], required: Iterable[str]) -> None:
        if not isinstance(self.data, dict):
            self.refuse("expected an object")
        for key in sorted(required):
            if key not in self.data:
                self.refuse(f"{key!r} is missing")
        for key in sorted(self.data.keys() - known):
            self.refuse(f"unknown key {key[:60]!r}")

    def event(self) -> RecordedEvent:
        """Return the event on this line."""
        self.check_keys(_LINE, required=("time", "event", "state"))
        answer = self.data.get("answer")
        if answer is not None and not isinstance(answer, bool):
            self.refuse(f"answer must be true or false, not {answer!r}")
        try:
            kind, state = Event(self.data["event"]), State(self.data["state"])
        except ValueError as error:
            self.refuse(str(error))
        notice = Notice(
            kind,
            self.action("action", self.text("action")) if "action" in self.data else (),
            tuple(map(self.fact, self.list_of_texts("facts"))),
            answer,
            tuple(self.action("plan", text) for text in self.list_of_texts("plan")),
            self.text("reason"),
            self.text("agent"),
        )
        time_s = self.number("time", self.data["time"])
        return RecordedEvent(notice, time_s, state, self.text("refusal"), self.text("digest"))

    def text(self, key: str) -> str:
        value = self.data.get(key, "")
        if not isinstance(value, str):
            self.refuse(f"{key} must be text")
        return value

    def truth(self, key: str) -> bool:
        value = self.data.get(key, False)
        if not isinstance(value, bool):
            self.refuse(f"{key} must be true or false")
        return value

    def items(self, key: str) -> list[object]:
        value = self.data.get(key, [])
        if not isinstance(value, list):
            self.refuse(f"{key} must be a list")
        return value

    def list_of_texts(self, key: str) -> list[str]:
        texts = [text for text in self.items(key) if isinstance(text, str)]
        if len(texts) < len(self.items(key)):
            self.refuse(f"{key} must be a list of texts")
        return texts

    def number(self, key: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < 1e15:
            self.refuse(f"{key}: expected a number of seconds, not {str(value)[:60]}")
        return float(value)

    def count(self, key: str) -> int:
        value = self.data[key]
        if type(value) is not int or value < 0:
            self.refuse(f"{key} must be a number of events")
        return value

    def action(self, key: str, text: str) -> GroundAtom:
        try:
            return parse_action(text)
        except PlanError as error:
            self.refuse(f"{key}: {error.message}")

    def fact(self, text: str) -> Fact:
        """Read ``(clear c)`` or ``(not (clear c))``."""
        inner = text.removeprefix("(not ").removesuffix(")")
        is_denied = text.startswith("(not (")
        return Fact(self.action("facts", inner if is_denied else text), not is_denied)

"""What every column of the exported tables means."""

from collections.abc import Mapping
from types import MappingProxyType

TABLES: Mapping[str, str] = MappingProxyType(
    {
        "labelled-steps": "One row a step that was taken in a task, with its label: the table to analyse.",
        "participants": "One row a participant; erased ones remain as tombstones.",
        "sessions": "One row a session.",
        "assignments": "One row a task that was given to a participant.",
        "answers": "One row an answer to a question, a rating, an attention check, or a comment.",
        "events": "One row an event, in the order in which the server took them; none is ever changed.",
    }
)

COLUMNS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "agent": ("string", "Who took the step."),
        "assignment": ("integer", "The task given to a participant, as in the table assignments."),
        "announced": ("string", "The robot's step that was announced when the session stopped, if one was."),
        "attempt": ("integer", "How often the questions had been tried before."),
        "attempts": ("integer", "How often the comprehension questions were tried."),
        "client_time": ("number", "Seconds since 1970 by the participant's clock when the answer was sent."),
        "condition": ("string", "Experimental condition, as named in study.toml."),
        "created": ("number", "Seconds since 1970 (UTC) at the beginning."),
        "data": ("string", "What belongs to the event, as JSON."),
        "ended": ("number", "Seconds since 1970 (UTC) when the task was finished."),
        "erased": (
            "number",
            "Seconds since 1970 (UTC) when the participant's data were erased.",
        ),
        "explicable": ("boolean", "The label: did the step make sense? Empty where nobody was asked."),
        "id": ("string", "Key of the row."),
        "kind": ("string", "play or replay or practice; in events, what happened."),
        "latency_s": ("number", "Seconds between question and answer, by the participant's clock."),
        "name": ("string", "The question, as named or numbered in study.toml."),
        "number": ("integer", "Place of the step in its plan, counted from 0."),
        "operator": ("string", "The step, as PDDL writes it."),
        "origin": ("string", "person or simulated; simulated participants are test instruments, no people."),
        "participant": ("string", "Name under which the participant's data go."),
        "position": ("integer", "Which of the participant's tasks; 0 is practice."),
        "revision": ("integer", "How often the session changed."),
        "seed": ("integer", "Number from which, with the study's seed, the session's chance comes."),
        "seen": ("number", "Seconds since 1970 (UTC) of the last sign of life."),
        "server_time": (
            "number",
            "Seconds since 1970 (UTC) by the server's clock; of a step that a page showed without asking,"
            " those of the answer less its latency_s.",
        ),
        "session": ("string", "The session, as in the table sessions."),
        "source": ("string", "What made the plan that was shown, as named in study.toml."),
        "stage": ("string", "Part of the session."),
        "started": ("number", "Seconds since 1970 (UTC) when the task was begun."),
        "status": ("string", "open, started, done, or freed: given back without being finished."),
        "study": ("string", "SHA-256 of the study's files when the session began."),
        "task": ("string", "The task, as named in study.toml."),
        "value": ("string", "The answer."),
        "version": ("string", "Version of explicable when the session began."),
    }
)
"""Type and meaning by column; a column means the same in every table."""


def format_codebook(tables: Mapping[str, list[str]]) -> str:
    """Write the codebook of some tables, given with their columns, as Markdown.

    Examples
    --------
    >>> print(format_codebook({"participants": ["id"]}).splitlines()[-1])
    | `id` | string | Key of the row. |
    """
    lines = ["# Codebook", "", "Empty cells are missing values. No recruitment ids are in these tables."]
    for table, columns in tables.items():
        lines += [
            "",
            f"## {table}",
            "",
            TABLES[table],
            "",
            "| column | type | meaning |",
            "| --- | --- | --- |",
        ]
        lines += [f"| `{column}` | {COLUMNS[column][0]} | {COLUMNS[column][1]} |" for column in columns]
    return "\n".join(lines) + "\n"

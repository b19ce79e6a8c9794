"""What requests leave in the database besides their effect: a note of each, and places given back."""

import json
from collections.abc import Mapping
from dataclasses import dataclass

from explicable.study import schema as tables
from explicable.study.protocol import ACTIVE
from explicable.study.transaction import Transaction

OPEN_STAGES = [stage.value for stage in ACTIVE]


@dataclass(frozen=True, slots=True)
class Request:
    """What every request brings along.

    Parameters
    ----------
    id
        Made by the client; a request with a known one is not carried out again.
    time
        The server's clock, seconds since 1970.
    client_time, latency_s
        The participant's clock, and how long the answer took by it.
    """

    id: str
    time: float
    client_time: float | None = None
    latency_s: float | None = None


def note(
    tx: Transaction,
    session: str,
    origin: str,
    kind: str,
    request: Request,
    data: Mapping[str, object],
) -> None:
    """Write down that something happened: once for each request, whatever is sent twice."""
    tx.add(
        tables.EVENTS,
        session=session,
        origin=origin,
        kind=kind,
        request=request.id,
        data=json.dumps(data, ensure_ascii=False, sort_keys=True),
        latency_s=request.latency_s,
        client_time=request.client_time,
        server_time=request.time,
    )


def free_tasks(tx: Transaction, session: str) -> None:
    """Give back the places of the tasks that a session has not finished."""
    for assignment in tx.all(tables.ASSIGNMENTS, session=session):
        if assignment.status != "done":
            tx.change(tables.ASSIGNMENTS, {"id": assignment.id}, status="freed")

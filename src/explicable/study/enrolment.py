"""Who takes part: places are given out, kept by whoever is at it, and given back."""

import secrets
from functools import cache
from importlib import metadata
from typing import TYPE_CHECKING

import numpy as np

from explicable.study import schema as tables
from explicable.study.assignment import draw_tasks, least_used, order_tasks
from explicable.study.ledger import OPEN_STAGES, Request, free_tasks, note
from explicable.study.materials import PRACTICE, Materials
from explicable.study.protocol import ConflictError, Event, Stage, advance
from explicable.study.recruitment import Recruit
from explicable.study.transaction import Places, Transaction

if TYPE_CHECKING:
    from collections.abc import Sequence


class NoPlaceError(ConflictError):
    """Nobody else can take part."""


class RepeatError(NoPlaceError):
    """Somebody who has taken part before can't do so again."""


def start(
    materials: Materials,
    tx: Transaction,
    request: Request,
    recruit: Recruit,
    simulated: str | None = None,
) -> str:
    """Begin a session for somebody who has consented; return its name.

    Parameters
    ----------
    simulated
        Name of the simulated participant, if it is one.

    Raises
    ------
    NoPlaceError
        If the study is full; a `RepeatError` if the person has taken part before.
    """
    known = tx.find(tables.SESSIONS, start_request=request.id)
    if known is not None:
        return str(known.id)
    tx.lock_places()
    before = _earlier_session(materials, tx, recruit)
    if before is not None:
        return before
    free_places(materials, tx, request.time)
    origin = "simulated" if simulated else "person"
    seed = sum(tx.count(tables.PARTICIPANTS).values())
    rng = np.random.default_rng((materials.study.seed, seed))
    condition = _condition(materials, tx, origin, rng)
    chosen = _draw(materials, tx.places(origin), condition, rng)
    if not chosen:
        raise NoPlaceError("nobody else is needed")
    participant = f"{simulated}-{secrets.token_hex(4)}" if simulated else f"p-{secrets.token_hex(8)}"
    _register(tx, request, recruit, participant, origin)
    session = secrets.token_urlsafe(32)
    tx.add(
        tables.SESSIONS,
        id=session,
        participant=participant,
        origin=origin,
        condition=condition,
        stage=advance(Stage.CONSENT, Event.CONSENTED).value,
        position=0,
        attempts=0,
        revision=0,
        start_request=request.id,
        code=secrets.token_hex(4).upper(),
        created=request.time,
        seen=request.time,
        study=materials.hash,
        version=_version(),
        seed=seed,
    )
    for position, task in enumerate((PRACTICE, *chosen)):
        kind = "practice" if position == 0 else materials.tasks[task].kind
        places = {"session": session, "origin": origin, "position": position}
        tx.add(tables.ASSIGNMENTS, **places, task=task, kind=kind, status="open")
    note(tx, session, origin, "consented", request, {"condition": condition})
    return session


def _register(tx: Transaction, request: Request, recruit: Recruit, participant: str, origin: str) -> None:
    """Write down a new participant, with what the recruitment platform told."""
    tx.add(tables.PARTICIPANTS, id=participant, origin=origin, created=request.time)
    for name, value in recruit.values.items():
        tx.add(tables.RECRUITS, participant=participant, platform=recruit.platform, name=name, value=value)


@cache
def _version() -> str:
    return metadata.version("explicable")


def free_places(materials: Materials, tx: Transaction, now: float) -> int:
    """Let sessions that have shown no sign of life for too long give their places back.

    ``now`` is the clock of day: what sessions were seen by outlives this process, and others share it.
    """
    silent = tx.silent_since(now - 60 * materials.study.time_limit_min, OPEN_STAGES)
    for session in silent:
        row = tx.lock_session(session, "")
        if row is None or row.stage not in OPEN_STAGES:
            continue  # somebody else has freed it meanwhile
        stage = advance(Stage(row.stage), Event.TIMED_OUT)
        free_tasks(tx, session)
        request = Request(f"timed-out-{secrets.token_hex(8)}", now)
        note(tx, session, row.origin, Event.TIMED_OUT.value, request, {"stage": row.stage})
        key = {"id": session, "revision": row.revision}
        tx.change(tables.SESSIONS, key, stage=stage.value, revision=row.revision + 1)
    return len(silent)


def _earlier_session(materials: Materials, tx: Transaction, recruit: Recruit) -> str | None:
    """Return the session to go on with, where everything in the link is as it was; refuse others."""
    person = recruit.person
    if person is None or materials.study.recruitment.allow_repeats:
        return None
    for row in tx.all(tables.RECRUITS, name=person[0], value=person[1]):
        told = {r.name: r.value for r in tx.all(tables.RECRUITS, participant=row.participant)}
        session = tx.find(tables.SESSIONS, participant=row.participant)
        same_visit = told == dict(recruit.values) and len(told) > 1
        if session is not None and same_visit:
            return str(session.id)
        raise RepeatError("this person has taken part before")
    return None


def _condition(materials: Materials, tx: Transaction, origin: str, rng: np.random.Generator) -> str:
    """Choose the condition that fewest people have who went on, or still may."""
    uses = dict.fromkeys(materials.conditions, 0)
    for (condition, stage), count in tx.count(tables.SESSIONS, "condition", "stage", origin=origin).items():
        if condition in uses and stage not in {Stage.RETURNED, Stage.EXCLUDED}:
            uses[condition] += count
    return least_used(list(uses), uses, rng)


def _draw(
    materials: Materials, taken: "Sequence[Places]", condition: str, rng: np.random.Generator
) -> list[str]:
    """Choose tasks: people for played maps are counted by condition, for plans altogether."""
    wanted = {task.name: task.people for task in materials.study.task}
    counts = dict.fromkeys(wanted, 0)
    times_at: dict[tuple[str, int], int] = {}
    for place in taken:
        if place.task in counts and (place.kind == "replay" or place.condition == condition):
            counts[place.task] += place.num
            key = place.task, place.position
            times_at[key] = times_at.get(key, 0) + place.num
    chosen = draw_tasks(wanted, counts, materials.study.tasks_each, rng)
    return order_tasks(chosen, times_at, rng)

"""What participants' requests do: the protocol and the game, applied to what the database holds.

Every function runs within one transaction. A request that was already carried out is not carried out again;
one that does not fit where the session stands raises, and the transaction leaves nothing behind.
"""

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import metadata
from typing import Any

import numpy as np

from explicable.labelling.traces import LabelledStep
from explicable.model.plan import format_action, parse_action
from explicable.study import schema as tables
from explicable.study.assignment import draw_tasks, least_used, order_tasks
from explicable.study.game import Moment
from explicable.study.materials import PRACTICE, Material, Materials
from explicable.study.protocol import ACTIVE, ConflictError, Event, Stage, advance
from explicable.study.recruitment import Recruit
from explicable.study.store import Row, Transaction, to_json

OPEN_STAGES = [stage.value for stage in ACTIVE]


class UnknownSessionError(ConflictError):
    """There is no such session, or no longer."""


class NoPlaceError(ConflictError):
    """Nobody else can take part."""


class RepeatError(NoPlaceError):
    """Somebody who has taken part before can't do so again."""


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


@dataclass(frozen=True, slots=True)
class Standing:
    """Where a session stands; task, material and moment where one is under way."""

    session: Row
    num_tasks: int
    assignment: Row | None = None
    material: Material | None = None
    moment: Moment | None = None

    @property
    def stage(self) -> Stage:
        """The stage."""
        return Stage(self.session.stage)


@dataclass(frozen=True)
class Conduct:
    """Conducts the sessions of a study."""

    materials: Materials

    def start(self, tx: Transaction, request: Request, recruit: Recruit, simulated: str | None = None) -> str:
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
        before = self._earlier_session(tx, recruit)
        if before is not None:
            return before
        self.free_places(tx, request.time)
        study, taken = self.materials.study, tx.places()
        seed = sum(tx.count(tables.PARTICIPANTS).values())
        rng = np.random.default_rng((study.seed, seed))
        sessions = tx.count(tables.SESSIONS, "condition", "stage")
        uses = dict.fromkeys(self.materials.conditions, 0)
        for (condition, stage), count in sessions.items():
            if condition in uses and stage not in {Stage.RETURNED, Stage.EXCLUDED}:
                uses[condition] += count
        condition = least_used(list(uses), uses, rng)
        chosen = self._draw(taken, condition, rng)
        if not chosen:
            raise NoPlaceError("nobody else is needed")
        session, origin = secrets.token_urlsafe(32), "simulated" if simulated else "person"
        participant = f"{simulated}-{secrets.token_hex(4)}" if simulated else f"p-{secrets.token_hex(8)}"
        tx.add(tables.PARTICIPANTS, id=participant, origin=origin, created=request.time)
        for name, value in recruit.values.items():
            tx.add(
                tables.RECRUITS, participant=participant, platform=recruit.platform, name=name, value=value
            )
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
            study=self.materials.hash,
            version=metadata.version("explicable"),
            seed=seed,
        )
        for position, task in enumerate((PRACTICE, *chosen)):
            kind = "practice" if position == 0 else self.materials.tasks[task].kind
            tx.add(
                tables.ASSIGNMENTS,
                session=session,
                origin=origin,
                position=position,
                task=task,
                kind=kind,
                status="open",
            )
        self._note(tx, session, origin, "consented", request, {"condition": condition})
        return session

    def standing(self, tx: Transaction, session: str) -> Standing:
        """Return where a session stands."""
        row = tx.find(tables.SESSIONS, id=session)
        if row is None:
            raise UnknownSessionError("there is no such session")
        return self._standing(tx, row)

    def standing_and_recruit(self, tx: Transaction, session: str) -> tuple[Standing, dict[str, str]]:
        """Return where a session stands, and what the recruitment platform told."""
        standing = self.standing(tx, session)
        rows = tx.all(tables.RECRUITS, participant=standing.session.participant)
        return standing, {row.name: row.value for row in rows}

    def step(self, tx: Transaction, session: str, request: Request, number: int) -> Standing:
        """Take the next step of the task, which is step ``number``, counted from 0; or announce it."""
        row = self._locked(tx, session)
        if self._is_repeated(tx, row, request):
            return self._standing(tx, row)
        standing, material, moment = self._task(tx, row, number)
        after = material.game.step(moment)
        self._record(tx, standing, moment, after, request)
        operator = format_action(after.announced or after.steps[-1].action)
        kind = "announced" if after.announced else "stepped"
        return self._went_on(tx, standing, after, request, kind, {"number": number, "operator": operator})

    def answer(
        self, tx: Transaction, session: str, request: Request, number: int, *, explicable: bool
    ) -> Standing:
        """Label the step that is asked about; ``number`` steps have been taken then."""
        row = self._locked(tx, session)
        if self._is_repeated(tx, row, request):
            return self._standing(tx, row)
        standing, material, moment = self._task(tx, row, number)
        after = material.game.answer(moment, explicable=explicable)
        self._record(tx, standing, moment, after, request)
        return self._went_on(
            tx, standing, after, request, "labelled", {"number": number, "explicable": explicable}
        )

    def command(self, tx: Transaction, session: str, request: Request, operator: str) -> Standing:
        """Take a step of the person's own."""
        row = self._locked(tx, session)
        if self._is_repeated(tx, row, request):
            return self._standing(tx, row)
        standing, material, moment = self._task(tx, row, None)
        after = material.game.command(moment, parse_action(operator))
        self._record(tx, standing, moment, after, request)
        return self._went_on(tx, standing, after, request, "commanded", {"operator": operator})

    def happen(
        self,
        tx: Transaction,
        session: str,
        request: Request,
        event: Event,
        answers: Mapping[str, str] | None = None,
    ) -> Standing:
        """Let an event of the course happen, with what was filled in.

        Raises
        ------
        ConflictError
            If it can't happen now.
        """
        row = self._locked(tx, session)
        if self._is_repeated(tx, row, request):
            return self._standing(tx, row)
        stage = Stage(row.stage)
        changes: dict[str, Any] = {"stage": advance(stage, event)}
        if event in {Event.UNDERSTOOD, Event.MISUNDERSTOOD, Event.GAVE_UP}:
            changes["attempts"] = row.attempts + 1
        if event is Event.UNDERSTOOD:
            changes["position"] = 1
        if event is Event.INSTRUCTED and self._assignment(tx, row, 0).status == "done":
            changes["stage"] = advance(Stage.PRACTICE, Event.PRACTISED)
        for name, value in (answers or {}).items():
            tx.add(
                tables.ANSWERS,
                session=session,
                stage=stage.value,
                attempt=row.attempts,
                name=name,
                origin=row.origin,
                value=value,
                server_time=request.time,
            )
        if changes["stage"] in {Stage.RETURNED, Stage.EXCLUDED}:
            self._free(tx, session)
        self._note(tx, session, row.origin, event.value, request, {"stage": stage.value})
        self._change(tx, row, request, **changes)
        return self.standing(tx, session)

    def free_places(self, tx: Transaction, now: float) -> int:
        """Let sessions that have shown no sign of life for too long give their places back."""
        silent = tx.silent_since(now - 60 * self.materials.study.time_limit_min, OPEN_STAGES)
        for session in silent:
            row = self._locked(tx, session)
            stage = advance(Stage(row.stage), Event.TIMED_OUT)
            self._free(tx, session)
            request = Request(f"timed-out-{secrets.token_hex(8)}", now)
            self._note(tx, session, row.origin, Event.TIMED_OUT.value, request, {"stage": row.stage})
            tx.change(tables.SESSIONS, {"id": session}, stage=stage.value, revision=row.revision + 1)
        return len(silent)

    def _earlier_session(self, tx: Transaction, recruit: Recruit) -> str | None:
        """Return the session to go on with, where everything in the link is as it was; refuse others."""
        person = recruit.person
        if person is None or self.materials.study.recruitment.allow_repeats:
            return None
        for row in tx.all(tables.RECRUITS, name=person[0], value=person[1]):
            told = {r.name: r.value for r in tx.all(tables.RECRUITS, participant=row.participant)}
            session = tx.find(tables.SESSIONS, participant=row.participant)
            same_visit = told == dict(recruit.values) and len(told) > 1
            if session is not None and same_visit:
                return str(session.id)
            raise RepeatError("this person has taken part before")
        return None

    def _draw(self, taken: list[Any], condition: str, rng: np.random.Generator) -> list[str]:
        """Choose tasks: people for played maps are counted by condition, for plans altogether."""
        wanted = {task.name: task.people for task in self.materials.study.task}
        counts = dict.fromkeys(wanted, 0)
        times_at: dict[tuple[str, int], int] = {}
        for place in taken:
            if place.task in counts and (place.kind == "replay" or place.condition == condition):
                counts[place.task] += 1
                key = place.task, place.position
                times_at[key] = times_at.get(key, 0) + 1
        chosen = draw_tasks(wanted, counts, self.materials.study.tasks_each, rng)
        return order_tasks(chosen, times_at, rng)

    def _locked(self, tx: Transaction, session: str) -> Row:
        row = tx.lock_session(session)
        if row is None:
            raise UnknownSessionError("there is no such session")
        return row

    def _is_repeated(self, tx: Transaction, row: Row, request: Request) -> bool:
        return tx.find(tables.EVENTS, session=row.id, request=request.id) is not None

    def _assignment(self, tx: Transaction, row: Row, position: int) -> Row:
        found = tx.find(tables.ASSIGNMENTS, session=row.id, position=position)
        if found is None:
            raise ConflictError("there is no such task in this session")
        return found

    def _standing(self, tx: Transaction, row: Row) -> Standing:
        num_tasks = len(tx.all(tables.ASSIGNMENTS, session=row.id)) - 1
        if row.stage not in {Stage.PRACTICE, Stage.TASKS}:
            return Standing(row, num_tasks)
        assignment = self._assignment(tx, row, row.position)
        steps = tuple(
            LabelledStep(step.agent, parse_action(step.operator), step.explicable)
            for step in tx.labelled_steps(assignment.id)
        )
        announced = parse_action(assignment.announced) if assignment.announced else None
        material = self.materials.material(assignment.task, row.condition)
        return Standing(row, num_tasks, assignment, material, Moment(steps, announced))

    def _task(self, tx: Transaction, row: Row, number: int | None) -> tuple[Standing, Material, Moment]:
        standing = self._standing(tx, row)
        if standing.material is None or standing.moment is None:
            raise ConflictError(f"no task is under way in the stage {row.stage!r}")
        if number is not None and number != len(standing.moment.steps):
            raise ConflictError("the task has gone on meanwhile")
        return standing, standing.material, standing.moment

    def _record(
        self, tx: Transaction, standing: Standing, before: Moment, after: Moment, request: Request
    ) -> None:
        """Write down the steps and labels that have come."""
        row, assignment = standing.session, standing.assignment
        if assignment is None:
            raise ConflictError("no task is under way")
        for number, step in enumerate(after.steps):
            old = before.steps[number] if number < len(before.steps) else None
            if old is None:
                tx.add(
                    tables.STEPS,
                    assignment=assignment.id,
                    number=number,
                    origin=row.origin,
                    agent=step.agent,
                    operator=format_action(step.action),
                    server_time=request.time,
                )
            if step.label is not None and (old is None or old.label is None):
                tx.add(
                    tables.LABELS,
                    assignment=assignment.id,
                    number=number,
                    origin=row.origin,
                    explicable=step.label,
                    request=request.id,
                    latency_s=request.latency_s,
                    client_time=request.client_time,
                    server_time=request.time,
                )

    def _went_on(
        self,
        tx: Transaction,
        standing: Standing,
        after: Moment,
        request: Request,
        kind: str,
        data: Mapping[str, object],
    ) -> Standing:
        """Close a task that is over, and write down what happened."""
        row, assignment, material = standing.session, standing.assignment, standing.material
        if assignment is None or material is None:
            raise ConflictError("no task is under way")
        is_over = material.game.is_over(after)
        announced = format_action(after.announced) if after.announced else None
        tx.change(
            tables.ASSIGNMENTS,
            {"id": assignment.id},
            announced=announced,
            started=assignment.started or request.time,
            ended=request.time if is_over else None,
            status="done" if is_over else "started",
        )
        self._note(tx, row.id, row.origin, kind, request, {"position": row.position, **data})
        if not is_over:
            self._change(tx, row, request)
        elif standing.stage is Stage.PRACTICE:
            self._change(tx, row, request, stage=advance(Stage.PRACTICE, Event.PRACTISED))
        else:
            is_last = row.position >= standing.num_tasks
            event = Event.FINISHED_TASKS if is_last else Event.FINISHED_TASK
            stage = advance(Stage.TASKS, event)
            self._change(tx, row, request, stage=stage, position=row.position + (not is_last))
        return self.standing(tx, row.id)

    def _change(self, tx: Transaction, row: Row, request: Request, **values: object) -> None:
        values = {name: value.value if isinstance(value, Stage) else value for name, value in values.items()}
        tx.change(tables.SESSIONS, {"id": row.id}, revision=row.revision + 1, seen=request.time, **values)

    def _free(self, tx: Transaction, session: str) -> None:
        for assignment in tx.all(tables.ASSIGNMENTS, session=session):
            if assignment.status != "done":
                tx.change(tables.ASSIGNMENTS, {"id": assignment.id}, status="freed")

    def _note(
        self,
        tx: Transaction,
        session: str,
        origin: str,
        kind: str,
        request: Request,
        data: Mapping[str, object],
    ) -> None:
        tx.add(
            tables.EVENTS,
            session=session,
            origin=origin,
            kind=kind,
            request=request.id,
            data=to_json(data),
            latency_s=request.latency_s,
            client_time=request.client_time,
            server_time=request.time,
        )

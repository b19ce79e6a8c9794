"""What participants' requests do: the protocol and the game, applied to what the database holds.

Every function runs within one transaction. A request that was already carried out is not carried out again;
one that does not fit where the session stands raises, and the transaction leaves nothing behind.

Where a session stands is remembered, so that most requests read nothing. What is remembered may be out of
date, and a request may be a known one; then the database does not take the session's revision or the
request's id, and the writer runs the job once more, without the memory.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from explicable.labelling.traces import LabelledStep
from explicable.model.plan import format_action, parse_action
from explicable.study import schema as tables
from explicable.study.game import Moment
from explicable.study.ledger import Request, free_tasks, note
from explicable.study.materials import Material, Materials
from explicable.study.protocol import ConflictError, Event, Stage, advance
from explicable.study.standing import Assignment, Session, Standing
from explicable.study.transaction import Row, Transaction


class UnknownSessionError(ConflictError):
    """There is no such session, or no longer."""


@dataclass(frozen=True)
class Conduct:
    """Conducts the sessions of a study."""

    materials: Materials

    def standing(self, tx: Transaction, session: str) -> Standing:
        """Return where a session stands.

        Raises
        ------
        UnknownSessionError
            If there is no such session.
        """
        row = tx.find(tables.SESSIONS, id=session)
        if row is None:
            raise UnknownSessionError("there is no such session")
        return self._read(tx, _session_of(row))

    def standing_and_recruit(self, tx: Transaction, session: str) -> tuple[Standing, dict[str, str]]:
        """Return where a session stands; at its end also what the recruitment platform told, to go back."""
        standing = self.standing(tx, session)
        return standing, self.recruit(tx, session) if standing.stage is Stage.DEBRIEF else {}

    def recruit(self, tx: Transaction, session: str) -> dict[str, str]:
        """Return what the recruitment platform told about whose session it is."""
        row = tx.find(tables.SESSIONS, id=session)
        rows = tx.all(tables.RECRUITS, participant=row.participant) if row else []
        return {row.name: row.value for row in rows}

    def step(self, tx: Transaction, session: str, request: Request, number: int) -> Standing:
        """Take the next step of the task, which is step ``number``, counted from 0; or announce it."""
        standing, is_repeated = self._found(tx, session, request)
        if is_repeated:
            return standing
        material, moment = _task(standing, number)
        after = material.game.step(moment)
        operator = format_action(after.announced or after.steps[-1].action)
        kind = "announced" if after.announced else "stepped"
        return self._went_on(tx, standing, after, request, kind, {"number": number, "operator": operator})

    def answer(
        self,
        tx: Transaction,
        session: str,
        request: Request,
        number: int,
        *,
        explicable: bool,
        shown: str | None = None,
    ) -> Standing:
        """Label the step that is asked about; ``number`` counts the steps, the one shown included."""
        standing, is_repeated = self._found(tx, session, request)
        if is_repeated:
            return standing
        material, moment = _task(standing, number, shown)
        after = material.game.answer(moment, explicable=explicable)
        data = {"number": number, "explicable": explicable, **({"shown": shown} if shown else {})}
        return self._went_on(tx, standing, after, request, "labelled", data)

    def command(
        self, tx: Transaction, session: str, request: Request, operator: str, shown: str | None = None
    ) -> Standing:
        """Take a step of the person's own."""
        standing, is_repeated = self._found(tx, session, request)
        if is_repeated:
            return standing
        material, moment = _task(standing, None, shown)
        after = material.game.command(moment, parse_action(operator))
        expected = material.game.expected(moment.actions)
        data = {"operator": operator, "expected": expected and format_action(expected)}
        return self._went_on(
            tx, standing, after, request, "commanded", {**data, **({"shown": shown} if shown else {})}
        )

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
        standing, is_repeated = self._found(tx, session, request)
        if is_repeated:
            return standing
        row, stage = standing.session, standing.stage
        changes: dict[str, Any] = {"stage": advance(stage, event).value}
        if event in {Event.UNDERSTOOD, Event.MISUNDERSTOOD, Event.GAVE_UP}:
            changes["attempts"] = row.attempts + 1
        if event is Event.UNDERSTOOD:
            changes["position"] = 1
        if event is Event.INSTRUCTED and standing.assignments[0].status == "done":
            changes["stage"] = advance(Stage.PRACTICE, Event.PRACTISED).value
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
            free_tasks(tx, session)
        note(tx, session, row.origin, event.value, request, {"stage": stage.value})
        session_now = self._change(tx, row, request, **changes)
        return self._remember(tx, self._standing(tx, session_now, standing.assignments))

    def _found(self, tx: Transaction, session: str, request: Request) -> tuple[Standing, bool]:
        """Return where a session stands, and whether the request is a known one: from memory if possible."""
        remembered = tx.recall(session)
        if isinstance(remembered, Standing):
            return remembered, False
        row = tx.lock_session(session, request.id)
        if row is None:
            raise UnknownSessionError("there is no such session")
        return self._read(tx, _session_of(row)), bool(row.is_repeated)

    def _remember(self, tx: Transaction, standing: Standing) -> Standing:
        """Remember where a session stands now, and return it."""
        tx.remember(standing.session.id, standing)
        return standing

    def _read(self, tx: Transaction, session: Session) -> Standing:
        """Read where a session stands."""
        names = [field.name for field in fields(Assignment)]
        rows = tx.all(tables.ASSIGNMENTS, "position", session=session.id)
        assignments = tuple(Assignment(**{name: getattr(row, name) for name in names}) for row in rows)
        return self._standing(tx, session, assignments)

    def _standing(self, tx: Transaction, session: Session, assignments: tuple[Assignment, ...]) -> Standing:
        """Return where a session stands; read the steps of the task under way, if it has any."""
        if session.stage not in {Stage.PRACTICE, Stage.TASKS}:
            return Standing(session, assignments)
        assignment = assignments[session.position]
        rows = tx.labelled_steps(assignment.id) if assignment.started is not None else ()
        steps = tuple(LabelledStep(row.agent, parse_action(row.operator), row.explicable) for row in rows)
        announced = parse_action(assignment.announced) if assignment.announced else None
        material = self.materials.material(assignment.task, session.condition)
        return Standing(session, assignments, material, material.game.moment(steps, announced))

    def _record(
        self, tx: Transaction, standing: Standing, before: Moment, after: Moment, request: Request
    ) -> None:
        """Write down the steps and labels that have come.

        A step that is labelled as it comes was seen before the answer, by the time that the answer took.
        """
        row = standing.session
        assignment = standing.assignments[row.position]
        for number, step in enumerate(after.steps):
            old = before.steps[number] if number < len(before.steps) else None
            if old is step:
                continue
            if old is None:
                tx.add(
                    tables.STEPS,
                    assignment=assignment.id,
                    number=number,
                    origin=row.origin,
                    agent=step.agent,
                    operator=format_action(step.action),
                    server_time=max(row.seen, request.time - (request.latency_s or 0.0)),
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
        """Write down what happened and what came of it, and close a task that is over."""
        row, material = standing.session, standing.material
        if material is None or standing.moment is None:
            raise ConflictError("no task is under way")
        self._record(tx, standing, standing.moment, after, request)
        is_over = material.game.is_over(after)
        before = standing.assignments[row.position]
        assignment = replace(
            before,
            status="done" if is_over else "started",
            announced=format_action(after.announced) if after.announced else None,
            started=before.started or request.time,
        )
        if assignment != before:
            tx.change(
                tables.ASSIGNMENTS,
                {"id": assignment.id},
                announced=assignment.announced,
                started=assignment.started,
                ended=request.time if is_over else None,
                status=assignment.status,
            )
        assignments = (
            *standing.assignments[: row.position],
            assignment,
            *standing.assignments[row.position + 1 :],
        )
        note(tx, row.id, row.origin, kind, request, {"position": row.position, **data})
        if not is_over:
            session = self._change(tx, row, request)
            return self._remember(
                tx, replace(standing, session=session, assignments=assignments, moment=after)
            )
        if standing.stage is Stage.PRACTICE:
            session = self._change(tx, row, request, stage=advance(Stage.PRACTICE, Event.PRACTISED).value)
        else:
            is_last = row.position >= standing.num_tasks
            stage = advance(Stage.TASKS, Event.FINISHED_TASKS if is_last else Event.FINISHED_TASK)
            position = row.position + (not is_last)
            session = self._change(tx, row, request, stage=stage.value, position=position)
        return self._remember(tx, self._standing(tx, session, assignments))

    def _change(self, tx: Transaction, session: Session, request: Request, **values: Any) -> Session:  # noqa: ANN401 (columns)
        """Change a session, if nothing has changed it meanwhile; its revision tells, also other tabs."""
        changed = replace(session, revision=session.revision + 1, seen=request.time, **values)
        key = {"id": session.id, "revision": session.revision}
        tx.change(tables.SESSIONS, key, revision=changed.revision, seen=request.time, **values)
        return changed


def _task(standing: Standing, number: int | None, shown: str | None = None) -> tuple[Material, Moment]:
    """Return the task under way, of which ``number`` steps have been seen, the last of them as ``shown``."""
    if standing.material is None or standing.moment is None:
        raise ConflictError("no task is under way")
    moment = standing.moment if shown is None else standing.offer
    is_other = moment is None or (shown is not None and shown != moment.operator)
    if moment is None or is_other or (number is not None and number != len(moment.steps)):
        raise ConflictError("the task has gone on meanwhile")
    return standing.material, moment


def _session_of(row: Row) -> Session:
    return Session(**{field.name: getattr(row, field.name) for field in fields(Session)})

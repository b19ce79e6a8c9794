"""The pages that participants see: templates filled in, forms read."""

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import jinja2
from fastapi.responses import HTMLResponse, Response
from markdown_it import MarkdownIt
from markupsafe import Markup

from explicable.study.config import Question
from explicable.study.materials import PRACTICE, Materials
from explicable.study.pictures import map_key
from explicable.study.protocol import PARTS, Event, Stage
from explicable.study.recruitment import MTURK_HOSTS, return_link, submit_address
from explicable.study.security import HEADERS, Keys
from explicable.study.standing import Standing
from explicable.study.view import Views
from explicable.study.words import Language, language

HERE = Path(__file__).parent
MOST_COMMENT = 5000
TEMPLATES = {
    Stage.INSTRUCTIONS: "instructions.html",
    Stage.PRACTICE: "task.html",
    Stage.COMPREHENSION: "comprehension.html",
    Stage.TASKS: "task.html",
    Stage.RATINGS: "ratings.html",
    Stage.DEBRIEF: "debrief.html",
    Stage.EXCLUDED: "ended.html",
    Stage.RETURNED: "ended.html",
}


@dataclass(frozen=True)
class Pages:
    """Makes the pages of a study."""

    materials: Materials
    keys: Keys
    views: Views

    @cached_property
    def templates(self) -> jinja2.Environment:
        """The templates, in the study's language."""
        environment = jinja2.Environment(
            loader=jinja2.FileSystemLoader(HERE / "templates"),
            autoescape=True,
            trim_blocks=True,
            lstrip_blocks=True,
            undefined=jinja2.StrictUndefined,
        )
        own = self.materials.language
        environment.globals.update(_=own.text, lang=own.code, study=self.materials.study)
        return environment

    def page(self, template: str, status: int = 200, /, **values: object) -> HTMLResponse:
        """Fill in a template."""
        return HTMLResponse(self.templates.get_template(template).render(**values), status)

    def admin(self, template: str, status: int = 200, /, **values: object) -> Response:
        """Fill in one of the researcher's pages, which are in English."""
        return self.page(template, status, lang="en", _=language("en").text, **values)

    def consent(self, recruit: dict[str, str], simulated: str | None) -> Response:
        """Ask for consent; the ticket carries over what the link told, and makes sending twice harmless."""
        ticket = {"request": secrets.token_hex(16), "recruit": recruit, "simulated": simulated}
        return self.page("consent.html", text=self._text("consent"), ticket=self.keys.sign("ticket", ticket))

    def preview(self, *, is_framed: bool) -> Response:
        """Show what people are asked to consent to, before they have accepted the task on their platform."""
        response = self.page("consent.html", text=self._text("consent"), ticket=None)
        return _in_frame(response) if is_framed else response

    def doorway(self, query: str, parameters: Mapping[str, str]) -> Response:
        """Lead out of a frame of Mechanical Turk into a tab, and take the completion code back there."""
        address, assignment = submit_address(parameters), parameters.get("assignmentId", "")
        return _in_frame(self.page("doorway.html", query=query, address=address, assignment=assignment))

    def declined(self) -> Response:
        """Thank somebody who does not want to take part, of whom nothing is stored."""
        return self._message("Thank you", "You have chosen not to take part. Nothing has been stored.")

    def no_place(self, *, is_repeat: bool) -> Response:
        """Say that nobody else can take part, or not this person again."""
        if is_repeat:
            message = "You have taken part in this study before. Thank you for your interest."
            return self._message("Thank you", message, 409)
        message = "Everybody whom we need has taken part. Thank you for your interest."
        return self._message("No place left", message, 409)

    def language_of(self, path: str) -> Language:
        """Return the language of what lies at a path: the researcher's pages are in English."""
        return language("en") if f"{path}/".startswith("/admin/") else self.materials.language

    def problem(self, message: str, status: int, own: Language) -> Response:
        """Say what is wrong with a request."""
        translated = own.text(message)
        return self.page(
            "message.html",
            status,
            lang=own.code,
            _=own.text,
            heading=own.text("That did not work"),
            message=f"{translated[:1].upper()}{translated[1:]}.",
            is_problem=True,
        )

    def session(
        self, standing: Standing, recruit: Mapping[str, str], filled_in: Mapping[str, str] | None = None
    ) -> Response:
        """Show a session where it stands; ``filled_in`` is a form that lacked something."""
        study, session, stage = self.materials.study, standing.session, standing.stage
        values: dict[str, object] = {
            "session": session,
            "stage": stage.value,
            "token": self.keys.token(session.id),
            "request_id": secrets.token_hex(16),
            "part": PARTS.index(stage) + 1 if stage in PARTS else None,
            "num_parts": len(PARTS),
            "filled_in": filled_in or {},
            "is_incomplete": filled_in is not None,
        }
        if stage is Stage.INSTRUCTIONS:
            shown = self.materials.tasks.values()
            has_map = any(task.renderer == "first-response" for task in shown)
            signs = map_key(self.materials.language.text) if has_map else []
            values.update(
                condition=self.materials.material(PRACTICE, session.condition).condition,
                text=self._text("instructions"),
                key=[(Markup(sign), meaning) for sign, meaning in signs],  # noqa: S704 (our own)
                has_play=any(task.kind == "play" for task in shown),
                has_replay=any(task.kind == "replay" for task in shown),
            )
        elif stage in {Stage.PRACTICE, Stage.TASKS}:
            view = self.views.view(standing)
            values.update(
                view=view,
                condition=self.materials.conditions[session.condition],
                picture=Markup(view.picture or ""),  # noqa: S704 (the package's own, escaped where it is made)
                view_json=self.views.json(standing),
            )
        elif stage is Stage.DEBRIEF:
            link = study.recruitment.return_url
            values.update(text=self._text("debrief"), link=link and return_link(link, session.code, recruit))
        return self.page(TEMPLATES[stage], 200, **values)

    def request_id(self, form: Mapping[str, str]) -> str:
        """Return a form's request id; a form without one is a request of its own."""
        found = form.get("request_id", "")
        return found if found.isalnum() and 8 <= len(found) <= 64 else secrets.token_hex(16)

    def read_form(self, standing: Standing, form: Mapping[str, str]) -> tuple[Event | None, dict[str, str]]:
        """Return the event that a form stands for, with the answers in it; no event if it lacks some."""
        study, stage = self.materials.study, standing.stage
        if form.get("decision") == "leave":
            return Event.LEFT, {}
        if stage is Stage.INSTRUCTIONS:
            return Event.INSTRUCTED, {}
        if stage is Stage.COMPREHENSION:
            answers = _chosen("question", study.question, form)
            if len(answers) < len(study.question):
                return None, {}
            right = all(
                answers[f"question-{number}"] == question.answer
                for number, question in enumerate(study.question, start=1)
            )
            if right:
                return Event.UNDERSTOOD, answers
            is_last = standing.session.attempts + 1 >= study.max_attempts
            return (Event.GAVE_UP if is_last else Event.MISUNDERSTOOD), answers
        if stage is Stage.RATINGS:
            return self._read_ratings(form)
        return None, {}

    def _read_ratings(self, form: Mapping[str, str]) -> tuple[Event | None, dict[str, str]]:
        study = self.materials.study
        marks = [str(mark) for mark in range(1, 11)]
        answers = {
            rating.name: form[f"rating-{rating.name}"]
            for rating in study.rating
            if form.get(f"rating-{rating.name}") in marks
        }
        checks = _chosen("check", study.check, form)
        if len(answers) < len(study.rating) or len(checks) < len(study.check):
            return None, {}
        return Event.RATED, {**answers, **checks, "comment": form.get("comment", "")[:MOST_COMMENT]}

    def _text(self, name: str) -> Markup:
        own = self.materials.text(name)
        if own is None:
            code = self.materials.study.language
            own = (HERE / "texts" / code / f"{name}.md").read_text(encoding="utf-8")
        return Markup(MarkdownIt("commonmark", {"html": False}).render(own))  # noqa: S704 (HTML in it is escaped)

    def _message(self, heading: str, message: str, status: int = 200) -> Response:
        heading, message = map(self.materials.language.text, (heading, message))
        return self.page("message.html", status, heading=heading, message=message, is_problem=False)


def _in_frame(response: Response) -> Response:
    """Let a page be shown by Mechanical Turk in a frame, and hand in there what is filled in."""
    own, turk = HEADERS["Content-Security-Policy"], " ".join(MTURK_HOSTS)
    policy = own.replace("frame-ancestors 'none'", f"frame-ancestors {turk}")
    policy = policy.replace("form-action 'self'", f"form-action {turk}")
    response.headers["Content-Security-Policy"] = policy
    return response


def _chosen(kind: str, questions: list[Question], form: Mapping[str, str]) -> dict[str, str]:
    """Return the choices made, as far as they are offered."""
    found = {}
    for number, question in enumerate(questions, start=1):
        name = f"{kind}-{number}"
        if form.get(name) in question.choices:
            found[name] = form[name]
    return found

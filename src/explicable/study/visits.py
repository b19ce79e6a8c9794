"""The participants' pages: they come, consent, and go through their session."""

import time
from dataclasses import dataclass
from importlib import metadata

from fastapi import APIRouter, HTTPException
from fastapi import Request as HTTPRequest
from fastapi.responses import RedirectResponse, Response

from explicable.study.conduct import UnknownSessionError
from explicable.study.enrolment import NoPlaceError, RepeatError, start
from explicable.study.forms import read_form
from explicable.study.ledger import Request
from explicable.study.protocol import ACTIVE, ConflictError
from explicable.study.recruitment import Recruit, is_preview, read_parameters
from explicable.study.security import SESSION_COOKIE
from explicable.study.server import READING, Server
from explicable.study.transaction import Transaction


@dataclass(frozen=True)
class Visits:
    """Answers what browsers ask for outside a task."""

    server: Server

    def routes(self) -> APIRouter:
        """Return what is answered by which function."""
        routes = APIRouter(include_in_schema=False)
        routes.add_api_route("/health", self.health, methods=READING)
        routes.add_api_route("/", self.welcome, methods=READING)
        routes.add_api_route("/consent", self.consent, methods=["POST"])
        routes.add_api_route("/session", self.session, methods=READING)
        routes.add_api_route("/session", self.go_on, methods=["POST"])
        return routes

    async def health(self) -> dict[str, str]:
        """Tell that the study is served, and which."""
        await self.server.read(Transaction.is_alive)
        version, study = metadata.version("explicable"), self.server.materials.hash
        return {"status": "ok", "version": version, "study": study}

    async def welcome(self, request: HTTPRequest) -> Response:
        """Ask for consent, or lead back to the session that is under way in this browser."""
        server, parameters = self.server, request.query_params
        platform = server.materials.study.recruitment.platform
        is_framed = request.headers.get("sec-fetch-dest") == "iframe"
        if is_preview(platform, parameters):
            return server.pages.preview(is_framed=is_framed)
        if platform == "mturk" and is_framed:
            return server.pages.doorway(str(request.url.query), parameters)
        recruit = read_parameters(platform, parameters)
        session = server.named_session(request.cookies.get(SESSION_COOKIE))
        if session is not None and "simulated" not in parameters:
            told = await server.read(lambda tx: server.conduct.recruit(tx, session))
            if not recruit.values or recruit.values == told:  # the same visit, from the same browser
                return RedirectResponse("/session", 303)
        simulated = server.keys.read("simulated", parameters.get("simulated"))
        return server.pages.consent(dict(recruit.values), simulated if isinstance(simulated, str) else None)

    async def consent(self, request: HTTPRequest) -> Response:
        """Begin a session for who consents."""
        server, form = self.server, await read_form(request)
        ticket = server.keys.read("ticket", form.get("ticket"))
        if not isinstance(ticket, dict):
            raise HTTPException(403, "this request does not come from a page of the study")
        if form.get("decision") != "yes":
            return server.pages.declined()
        recruit = Recruit(server.materials.study.recruitment.platform, ticket["recruit"])
        asked, simulated = Request(ticket["request"], time.time()), ticket["simulated"]
        try:
            session = await server.write(lambda tx: start(server.materials, tx, asked, recruit, simulated))
        except NoPlaceError as error:
            return server.pages.no_place(is_repeat=isinstance(error, RepeatError))
        response = RedirectResponse("/session", 303)
        response.set_cookie(
            SESSION_COOKIE,
            server.keys.sign("session", session),
            max_age=30 * 24 * 3600,
            httponly=True,
            samesite="lax",
            secure=request.url.scheme == "https",
        )
        return response

    async def session(self, request: HTTPRequest) -> Response:
        """Show a session where it stands."""
        server = self.server
        session = server.keys.read("session", request.cookies.get(SESSION_COOKIE))
        if not isinstance(session, str):
            return RedirectResponse("/", 303)
        try:
            standing, recruit = await server.read(lambda tx: server.conduct.standing_and_recruit(tx, session))
        except UnknownSessionError:  # forgotten, or of another study that was served here
            response = RedirectResponse("/", 303)
            response.delete_cookie(SESSION_COOKIE)
            return response
        return server.pages.session(standing, recruit)

    async def go_on(self, request: HTTPRequest) -> Response:
        """Take what was filled in, and go on; or show what is missing."""
        server, form = self.server, await read_form(request)
        session = server.own_session(request, form.get("token"))
        standing = await server.read(lambda tx: server.conduct.standing(tx, session))
        is_leaving = form.get("decision") == "leave" and standing.stage in ACTIVE
        if standing.stage.value != form.get("stage") and not is_leaving:
            return RedirectResponse("/session", 303)  # sent twice, or from another tab: go on from here
        event, answers = server.pages.read_form(standing, form)
        asked = Request(server.pages.request_id(form), time.time())
        if event is not None:
            try:
                await server.write(lambda tx: server.conduct.happen(tx, session, asked, event, answers))
            except UnknownSessionError:
                raise
            except ConflictError:
                return RedirectResponse("/session", 303)  # another tab was quicker: go on from there
            return RedirectResponse("/session", 303)
        # Not redirected: nothing of a form that lacks something is kept, so this answer alone can show it.
        return server.pages.session(standing, {}, filled_in=form)

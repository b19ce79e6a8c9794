"""The participants' pages and their interface for scripts: HTTP in, `Conduct` asked, HTTP out."""

import asyncio
import threading
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib import metadata
from pathlib import Path
from typing import TypeVar

from fastapi import APIRouter, FastAPI, HTTPException
from fastapi import Request as HTTPRequest
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, RedirectResponse, Response
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException as AnyHTTPException
from starlette.types import ASGIApp

from explicable.errors import InputError
from explicable.study.conduct import Conduct, UnknownSessionError
from explicable.study.enrolment import NoPlaceError, RepeatError, start
from explicable.study.forms import read_form
from explicable.study.interface import FrontDoor, Problem, add_interface
from explicable.study.ledger import Request
from explicable.study.pages import Pages
from explicable.study.protocol import ACTIVE, ConflictError
from explicable.study.recruitment import Recruit, is_preview, read_parameters
from explicable.study.security import SESSION_COOKIE, Guard, Keys, Limiter
from explicable.study.server import Server
from explicable.study.store import Store
from explicable.study.transaction import Transaction
from explicable.study.view import Views
from explicable.study.writer import UnavailableError

HERE = Path(__file__).parent
T = TypeVar("T")


def create_app(
    folder: Path, url: str, *, trusts_floods: bool = False, closing: threading.Event | None = None
) -> ASGIApp:
    """Make the web application of a study whose database exists.

    Parameters
    ----------
    folder
        The study's folder.
    url
        Of its database.
    trusts_floods
        Whether requests are not limited: for load tests, where all come from one machine.
    closing
        Set when the server is about to stop, which ends the streams to open pages.
    """
    from explicable.study import admin
    from explicable.study.folder import read_secret
    from explicable.study.materials import read_materials

    materials = read_materials(folder)
    store = Store(url)
    keys = Keys(store.read(read_secret))
    views = Views(materials.language)
    pages = Pages(materials, keys, views)
    server = Server(materials, store, keys, Conduct(materials), pages, views, closing or threading.Event())

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        await asyncio.to_thread(materials.check)
        watching = asyncio.create_task(server.watch.run())
        yield
        watching.cancel()
        await asyncio.to_thread(store.close)

    app = FastAPI(
        title="explicable study",
        version=metadata.version("explicable"),
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/openapi.json",
    )
    rate = 1e9 if trusts_floods else 1.0
    add_interface(app, server)
    app.mount("/static", StaticFiles(directory=HERE / "static"))
    _handle_errors(app, server)
    app.include_router(_page_routes(server))
    app.include_router(admin.routes(server, Limiter(0.2 * rate, 10 * rate)))
    session, address = Limiter(20 * rate, 60 * rate), Limiter(20 * rate, 200 * rate)
    return Guard(FrontDoor(app), session=session, address=address)


def _handle_errors(app: FastAPI, server: Server) -> None:
    @app.exception_handler(ConflictError)
    async def conflict(request: HTTPRequest, error: ConflictError) -> Response:
        status = 401 if isinstance(error, UnknownSessionError) else 409
        if not request.url.path.startswith("/api/"):
            return server.pages.problem(str(error), status)
        return JSONResponse(Problem(error=str(error)).model_dump(), status)

    @app.exception_handler(UnavailableError)
    async def unavailable(request: HTTPRequest, error: UnavailableError) -> Response:
        if not request.url.path.startswith("/api/"):
            return server.pages.problem(str(error), 503)
        return JSONResponse(Problem(error=str(error)).model_dump(), 503, {"Retry-After": "1"})

    @app.exception_handler(InputError)
    async def bad_input(request: HTTPRequest, error: InputError) -> Response:
        if not request.url.path.startswith("/api/"):
            return server.pages.problem(error.message, 422)
        return JSONResponse(Problem(error=error.message).model_dump(), 422)

    @app.exception_handler(RequestValidationError)
    async def misshapen(_: HTTPRequest, error: RequestValidationError) -> Response:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        return JSONResponse(Problem(error=f"{place}: {first['msg']}").model_dump(), 422)

    @app.exception_handler(AnyHTTPException)
    async def refused(request: HTTPRequest, error: AnyHTTPException) -> Response:
        if error.status_code == 303 and error.headers:
            return RedirectResponse(error.headers["Location"], 303)
        if not request.url.path.startswith(("/api/", "/admin/maps/")):
            detail = "there is no such page" if error.status_code == 404 else str(error.detail)
            return server.pages.problem(detail, error.status_code)
        return JSONResponse(Problem(error=str(error.detail)).model_dump(), error.status_code)


def _page_routes(server: Server) -> APIRouter:
    routes = APIRouter(include_in_schema=False)
    pages, keys, study = server.pages, server.keys, server.materials.study

    @routes.get("/health")
    async def health() -> dict[str, str]:
        await server.read(Transaction.is_alive)
        return {"status": "ok", "version": metadata.version("explicable"), "study": server.materials.hash}

    @routes.get("/")
    async def welcome(request: HTTPRequest) -> Response:
        session = keys.read("session", request.cookies.get(SESSION_COOKIE))
        platform, is_framed = study.recruitment.platform, request.headers.get("sec-fetch-dest") == "iframe"
        if is_preview(platform, request.query_params):
            return pages.preview(is_framed=is_framed)
        if platform == "mturk" and is_framed:
            return pages.doorway(str(request.url.query), request.query_params)
        recruit = read_parameters(platform, request.query_params)
        if isinstance(session, str) and "simulated" not in request.query_params:
            told = await server.read(lambda tx: server.conduct.recruit(tx, session))
            if not recruit.values or recruit.values == told:  # the same visit, from the same browser
                return RedirectResponse("/session", 303)
        simulated = keys.read("simulated", request.query_params.get("simulated"))
        return pages.consent(dict(recruit.values), simulated if isinstance(simulated, str) else None)

    @routes.post("/consent")
    async def consent(request: HTTPRequest) -> Response:
        form = await read_form(request)
        ticket = keys.read("ticket", form.get("ticket"))
        if not isinstance(ticket, dict):
            raise HTTPException(403, "this request does not come from a page of the study")
        if form.get("decision") != "yes":
            return pages.declined()
        recruit = Recruit(study.recruitment.platform, ticket["recruit"])
        asked = Request(ticket["request"], time.time())
        simulated = ticket["simulated"]
        try:
            session = await server.write(lambda tx: start(server.materials, tx, asked, recruit, simulated))
        except NoPlaceError as error:
            return pages.no_place(is_repeat=isinstance(error, RepeatError))
        response = RedirectResponse("/session", 303)
        response.set_cookie(
            SESSION_COOKIE,
            keys.sign("session", session),
            max_age=30 * 24 * 3600,
            httponly=True,
            samesite="lax",
            secure=request.url.scheme == "https",
        )
        return response

    @routes.get("/session")
    async def session_page(request: HTTPRequest) -> Response:
        session = keys.read("session", request.cookies.get(SESSION_COOKIE))
        if not isinstance(session, str):
            return RedirectResponse("/", 303)
        try:
            standing, recruit = await server.read(lambda tx: server.conduct.standing_and_recruit(tx, session))
        except UnknownSessionError:  # forgotten, or of another study that was served here
            response = RedirectResponse("/", 303)
            response.delete_cookie(SESSION_COOKIE)
            return response
        return pages.session(standing, recruit)

    @routes.post("/session")
    async def session_form(request: HTTPRequest) -> Response:
        form = await read_form(request)
        session = server.own_session(request, form.get("token"))
        standing = await server.read(lambda tx: server.conduct.standing(tx, session))
        is_leaving = form.get("decision") == "leave" and standing.stage in ACTIVE
        if standing.stage.value != form.get("stage") and not is_leaving:
            return RedirectResponse("/session", 303)  # sent twice, or from another tab: go on from here
        event, answers = pages.read_form(standing, form)
        asked = Request(pages.request_id(form), time.time())
        if event is not None:
            await server.write(lambda tx: server.conduct.happen(tx, session, asked, event, answers))
            return RedirectResponse("/session", 303)
        return pages.session(standing, {}, filled_in=form)

    return routes

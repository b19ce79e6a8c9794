"""The participants' pages and their interface for scripts: HTTP in, `Conduct` asked, HTTP out."""

import asyncio
import threading
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from importlib import metadata
from pathlib import Path
from typing import Annotated, TypeVar

from fastapi import APIRouter, FastAPI, HTTPException
from fastapi import Request as HTTPRequest
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, RedirectResponse, Response, StreamingResponse
from fastapi.staticfiles import StaticFiles
from pydantic import BaseModel, Field, FiniteFloat
from starlette.exceptions import HTTPException as AnyHTTPException

from explicable.errors import InputError
from explicable.study.conduct import Conduct, Standing, UnknownSessionError
from explicable.study.enrolment import NoPlaceError, RepeatError, start
from explicable.study.forms import read_form
from explicable.study.ledger import Request
from explicable.study.pages import Pages
from explicable.study.protocol import ACTIVE, ConflictError
from explicable.study.recruitment import Recruit, is_preview, read_parameters
from explicable.study.security import SESSION_COOKIE, Guard, Keys, Limiter
from explicable.study.server import Server
from explicable.study.store import Store
from explicable.study.transaction import Transaction
from explicable.study.view import View, Views
from explicable.study.writer import UnavailableError

HERE = Path(__file__).parent
T = TypeVar("T")

RequestId = Annotated[str, Field(pattern=r"^[A-Za-z0-9-]{8,64}$")]


class Move(BaseModel):
    """Asks for the next step of the task; ``number`` steps have been seen."""

    request_id: RequestId
    number: Annotated[int, Field(ge=0, le=100_000)]
    client_time: FiniteFloat | None = None


class Answer(Move):
    """Says whether the step that is asked about makes sense."""

    explicable: bool
    latency_s: Annotated[FiniteFloat, Field(ge=0, le=1e6)] | None = None


class Order(BaseModel):
    """Gives a command, by its operator."""

    request_id: RequestId
    operator: Annotated[str, Field(min_length=3, max_length=500)]
    client_time: FiniteFloat | None = None


class Problem(BaseModel):
    """Why a request was not carried out, and how things stand."""

    error: str
    view: View | None = None


def create_app(
    folder: Path, url: str, *, trusts_floods: bool = False, closing: threading.Event | None = None
) -> FastAPI:
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
    app.add_middleware(Guard, session=Limiter(20 * rate, 60 * rate), address=Limiter(20 * rate, 200 * rate))
    app.mount("/static", StaticFiles(directory=HERE / "static"))
    _handle_errors(app, server)
    app.include_router(_page_routes(server))
    app.include_router(_script_routes(server))
    app.include_router(admin.routes(server, Limiter(0.2 * rate, 10 * rate)))
    return app


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
            return server.pages.problem(str(error.detail), error.status_code)
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
        if is_preview(study.recruitment.platform, request.query_params):
            return pages.preview()
        recruit = read_parameters(study.recruitment.platform, request.query_params)
        if isinstance(session, str) and not recruit.values and "simulated" not in request.query_params:
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
        standing, recruit = await server.read(lambda tx: server.conduct.standing_and_recruit(tx, session))
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


def _script_routes(server: Server) -> APIRouter:
    routes = APIRouter(
        prefix="/api",
        responses={code: {"model": Problem} for code in (400, 401, 403, 409, 413, 422, 429, 503)},
    )
    conduct, views = server.conduct, server.views
    has_teaming = any(condition.mode == "teaming" for condition in server.materials.study.conditions)

    @routes.get("/view")
    async def view(request: HTTPRequest) -> View:
        session = server.session(request)
        return await server.read(lambda tx: views.view(conduct.standing(tx, session)))

    async def think_ahead(session: str) -> None:
        """Let the robot plan before the transaction in which it moves: nobody waits for a plan then.

        The transaction finds the plan, unless the task has gone on meanwhile: then it refuses the step.
        """
        standing = await server.read(lambda tx: conduct.standing(tx, session))
        if standing.material is not None and standing.moment is not None and standing.is_teaming:
            await asyncio.to_thread(standing.material.game.upcoming, standing.moment)

    async def carry_out(request: HTTPRequest, job: Callable[[Transaction, str], Standing]) -> Response:
        session = server.own_session(request, request.headers.get("x-token"))
        try:
            standing = await server.write(lambda tx: job(tx, session))
        except UnknownSessionError:
            raise
        except ConflictError as error:
            shown = await server.read(lambda tx: views.view(conduct.standing(tx, session)))
            return _json(Problem(error=str(error), view=shown), 409)
        if standing.is_teaming:
            # The robot may plan now: aside, so that others need not wait.
            return _json(await asyncio.to_thread(views.view, standing))
        return _json(views.view(standing))

    @routes.post("/step", response_model=View)
    async def step(request: HTTPRequest, move: Move) -> Response:
        asked = Request(move.request_id, time.time(), move.client_time)
        if has_teaming:
            await think_ahead(server.own_session(request, request.headers.get("x-token")))
        return await carry_out(request, lambda tx, session: conduct.step(tx, session, asked, move.number))

    @routes.post("/answer", response_model=View)
    async def answer(request: HTTPRequest, answer: Answer) -> Response:
        asked = Request(answer.request_id, time.time(), answer.client_time, answer.latency_s)
        return await carry_out(
            request,
            lambda tx, session: conduct.answer(
                tx, session, asked, answer.number, explicable=answer.explicable
            ),
        )

    @routes.post("/command", response_model=View)
    async def command(request: HTTPRequest, order: Order) -> Response:
        asked = Request(order.request_id, time.time(), order.client_time)
        return await carry_out(
            request, lambda tx, session: conduct.command(tx, session, asked, order.operator)
        )

    @routes.get("/changes", include_in_schema=False)
    async def changes(request: HTTPRequest) -> Response:
        session = server.session(request)
        stream = server.watch.listen(session, request.is_disconnected)
        return StreamingResponse(stream, media_type="text/event-stream")

    return routes


def _json(model: BaseModel, status: int = 200) -> Response:
    return Response(model.model_dump_json(), status, media_type="application/json")

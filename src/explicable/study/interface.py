"""The interface for scripts: what pages send while a task is under way, and what they get to see.

It is what a server does most, so these requests do not take the way through the web framework, which takes
longer than to answer them.
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, get_type_hints

from fastapi import FastAPI
from fastapi import Request as HTTPRequest
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response, StreamingResponse
from fastapi.routing import APIRoute
from pydantic import BaseModel, Field, FiniteFloat, TypeAdapter, ValidationError
from starlette.middleware.exceptions import ExceptionMiddleware
from starlette.types import Receive, Scope, Send

from explicable.study.conduct import UnknownSessionError
from explicable.study.ledger import Request
from explicable.study.protocol import ConflictError
from explicable.study.server import READING, Server
from explicable.study.standing import Standing
from explicable.study.transaction import Transaction
from explicable.study.view import View

Operator = Annotated[str, Field(min_length=3, max_length=500)]
RequestId = Annotated[str, Field(pattern=r"^[A-Za-z0-9-]{8,64}$")]


class Move(BaseModel):
    """Asks for the next step of the task; ``number`` steps have been seen."""

    request_id: RequestId
    number: Annotated[int, Field(ge=0, le=100_000)]
    client_time: FiniteFloat | None = None


class Answer(Move):
    """Says whether the step that is asked about makes sense; ``shown``, if the page showed it by itself."""

    explicable: bool
    shown: Operator | None = None
    latency_s: Annotated[FiniteFloat, Field(ge=0, le=1e6)] | None = None


class Order(BaseModel):
    """Gives a command, by its operator; ``shown`` is the step that the page has shown by itself before."""

    request_id: RequestId
    operator: Operator
    shown: Operator | None = None
    client_time: FiniteFloat | None = None


class Problem(BaseModel):
    """Why a request was not carried out, and how things stand."""

    error: str
    view: View | None = None


class DirectRoute(APIRoute):
    """A POST route with a JSON body, described like any other and served by `FrontDoor`.

    The endpoint takes ``request`` and ``body``, and returns a response.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:  # noqa: ANN401 (its parent's)
        super().__init__(path, endpoint, **options)
        (body,) = (
            kind for name, kind in get_type_hints(endpoint).items() if name not in {"request", "return"}
        )
        self.body = TypeAdapter(body)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one request."""
        if scope["method"] != "POST":
            await super().handle(scope, receive, send)
            return
        request = HTTPRequest(scope, receive, send)
        if not request.headers.get("content-type", "").startswith("application/json"):
            raise RequestValidationError([{"loc": ("body",), "msg": "JSON is expected"}])
        try:
            body = self.body.validate_json(await request.body())
        except ValidationError as error:
            raise RequestValidationError(
                [{**problem, "loc": ("body", *problem["loc"])} for problem in error.errors()]
            ) from error
        response = await self.endpoint(request, body)
        await response(scope, receive, send)


class FrontDoor:
    """Serves direct routes itself, and leaves all else to the application with its middleware."""

    def __init__(self, app: FastAPI) -> None:
        self.app = app
        self.routes = {route.path: route for route in app.router.routes if isinstance(route, DirectRoute)}
        self.direct = ExceptionMiddleware(self._serve, handlers=app.exception_handlers)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one request."""
        is_direct = scope["type"] == "http" and scope["method"] == "POST" and scope["path"] in self.routes
        await (self.direct if is_direct else self.app)(scope, receive, send)

    async def _serve(self, scope: Scope, receive: Receive, send: Send) -> None:
        await self.routes[scope["path"]].handle(scope, receive, send)


@dataclass(frozen=True)
class Interface:
    """Answers what pages ask and send while a task is under way."""

    server: Server

    def add_to(self, app: FastAPI) -> None:
        """Let an application answer so."""
        responses: dict[int | str, dict[str, Any]] = {
            code: {"model": Problem} for code in (400, 401, 403, 409, 413, 422, 429, 503)
        }
        app.add_api_route("/api/view", self.view, response_model=View, responses=responses)
        app.add_api_route("/api/view", self.view, methods=["HEAD"], include_in_schema=False)
        app.add_api_route("/api/changes", self.changes, methods=READING, include_in_schema=False)
        for act in (self.step, self.answer, self.command):
            app.router.add_api_route(
                f"/api/{act.__name__}",
                act,
                methods=["POST"],
                response_model=View,
                responses=responses,
                route_class_override=DirectRoute,
            )

    async def view(self, request: HTTPRequest) -> Response:
        """Show the task as it stands."""
        server, session = self.server, self.server.session(request)
        return _json(await server.read(lambda tx: server.views.json(server.conduct.standing(tx, session))))

    async def changes(self, request: HTTPRequest) -> Response:
        """Tell, as long as the page is open, when its session has gone on elsewhere."""
        session, kind = self.server.session(request), "text/event-stream"
        if request.method == "HEAD":
            return StreamingResponse((), media_type=kind)  # what is left out would never end
        stream = self.server.watch.listen(session, request.is_disconnected)
        return StreamingResponse(stream, media_type=kind)

    async def step(self, request: HTTPRequest, body: Move) -> Response:
        """Take the next step of the task."""
        conduct, asked = self.server.conduct, Request(body.request_id, time.time(), body.client_time)
        if self._has_teaming:
            await self._think_ahead(self.server.own_session(request, request.headers.get("x-token")))
        return await self._carry_out(
            request, lambda tx, session: conduct.step(tx, session, asked, body.number)
        )

    async def answer(self, request: HTTPRequest, body: Answer) -> Response:
        """Label the step that is asked about."""
        conduct = self.server.conduct
        asked = Request(body.request_id, time.time(), body.client_time, body.latency_s)
        return await self._carry_out(
            request,
            lambda tx, session: conduct.answer(
                tx, session, asked, body.number, explicable=body.explicable, shown=body.shown
            ),
        )

    async def command(self, request: HTTPRequest, body: Order) -> Response:
        """Take a command of the person's."""
        conduct, asked = self.server.conduct, Request(body.request_id, time.time(), body.client_time)
        return await self._carry_out(
            request, lambda tx, session: conduct.command(tx, session, asked, body.operator, body.shown)
        )

    @cached_property
    def _has_teaming(self) -> bool:
        return any(condition.mode == "teaming" for condition in self.server.materials.study.conditions)

    async def _think_ahead(self, session: str) -> None:
        """Let the robot plan before the transaction in which it moves: nobody waits for a plan then.

        The transaction finds the plan, unless the task has gone on meanwhile: then it refuses the step.
        """
        standing = await self.server.read(lambda tx: self.server.conduct.standing(tx, session))
        if standing.material is not None and standing.moment is not None and standing.is_teaming:
            await asyncio.to_thread(standing.material.game.upcoming, standing.moment)

    async def _carry_out(self, request: HTTPRequest, job: Callable[[Transaction, str], Standing]) -> Response:
        server, session = self.server, self.server.own_session(request, request.headers.get("x-token"))
        try:
            standing = await server.write(lambda tx: job(tx, session))
        except UnknownSessionError:
            raise
        except ConflictError as error:
            shown = await server.read(lambda tx: server.views.view(server.conduct.standing(tx, session)))
            message = server.materials.language.text(str(error))
            return _json(Problem(error=message, view=shown).model_dump_json(), 409)
        if standing.is_teaming:
            # The robot may plan now: aside, so that others need not wait.
            return _json(await asyncio.to_thread(server.views.json, standing))
        return _json(server.views.json(standing))


def _json(text: str, status: int = 200) -> Response:
    return Response(text, status, media_type="application/json")

"""Robots that pull their steps over HTTP: a server of ours, and the robot's end of it.

::

    GET  /v1/robots/NAME/next?wait_s=20   the step or cancellation that is open (200), or nothing (204);
                                          with seen=step-3, say, only what is not that
    POST /v1/robots/NAME/messages         a report, or hello (200, with what became of it)
    GET  /v1/robots/NAME                  whether it is connected, and the number of its open order

Every request carries ``Authorization: Bearer TOKEN``; each robot has its own token. A robot counts as
connected while it has been heard within the last ``silence_s``, also while it waits for a step.
"""

import asyncio
import hmac
import math
import socket
import threading
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Self

from explicable.errors import RobotError, UsageError
from explicable.execution.robots.messages import (
    MAX_BYTES,
    CancelMessage,
    StepMessage,
    encode_message,
    message_tag,
)
from explicable.execution.robots.remote import RemoteRobot, new_session

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response

_MAX_WAIT_S = 30.0
_BODY_TIMEOUT_S = 10.0
_MAX_CONNECTIONS = 256


class RestRobot(RemoteRobot):
    """A robot that asks for its steps; made by `RestServer`."""

    def __init__(self, name: str, session: str, silence_s: float) -> None:
        super().__init__(name, session, silence_s)
        self._message: StepMessage | CancelMessage | None = None
        self._wake: Callable[[], object] = lambda: None

    def _transmit(self, message: StepMessage | CancelMessage) -> None:
        self._message = message
        self._wake()

    def hear(self) -> None:
        """Note that the robot is there."""
        with self._lock:
            self._set_connected(connected=True)

    def next_message(self) -> StepMessage | CancelMessage | None:
        """Return what the robot has to know of its open order; once it is answered, there is nothing."""
        with self._lock:
            return self._message if self._book.order is not None and not self._closed else None


class RestServer:
    """Serves robots until it is closed; a context manager.

    Parameters
    ----------
    tokens
        The token of each robot, by its name; at least 16 characters each.
    host, port
        Where to listen; port 0 finds a free one, then ``server.port`` tells which.
    silence_s
        Robots unheard of for longer than this are not connected.

    Attributes
    ----------
    robots
        The robots by name, for `Door`.

    Raises
    ------
    UsageError
        Tokens that are too short or that two robots share.
    OSError
        If the port can't be had.
    """

    def __init__(
        self,
        tokens: Mapping[str, str],
        *,
        host: str = "127.0.0.1",
        port: int = 0,
        silence_s: float = 60.0,
    ) -> None:
        import uvicorn

        if any(len(token) < 16 for token in tokens.values()):
            raise UsageError("a token needs at least 16 characters")
        if len(set(tokens.values())) < len(tokens):
            raise UsageError("each robot needs a token of its own")
        session = new_session()
        self.robots = {name: RestRobot(name, session, silence_s) for name in tokens}
        self._tokens = dict(tokens)
        self._socket = socket.create_server((host, port))
        self.host, self.port = self._socket.getsockname()[:2]
        config = uvicorn.Config(
            self._application(),
            log_config=None,
            access_log=False,
            lifespan="off",
            limit_concurrency=_MAX_CONNECTIONS,
            timeout_graceful_shutdown=1,
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._serve, name="robots' REST server", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stop serving and close every robot."""
        for robot in self.robots.values():
            robot.close()
            robot._wake()
        self._server.should_exit = True
        self._thread.join(timeout=10)
        self._socket.close()

    def _serve(self) -> None:
        asyncio.run(self._server.serve(sockets=[self._socket]))

    def _application(self) -> "Starlette":
        from starlette.applications import Starlette
        from starlette.routing import Route

        return Starlette(
            routes=[
                Route("/v1/robots/{name}", self._show),
                Route("/v1/robots/{name}/next", self._next),
                Route("/v1/robots/{name}/messages", self._receive, methods=["POST"]),
            ]
        )

    async def _show(self, request: "Request") -> "Response":
        robot = self._robot(request)
        state = robot.state()
        return _answer(200, connected=state.connected, order=state.order.number if state.order else None)

    async def _next(self, request: "Request") -> "Response":
        from starlette.responses import Response

        robot = self._robot(request)
        wait_s = _seconds(request.query_params.get("wait_s", "0"))
        seen = request.query_params.get("seen")
        changed, loop = asyncio.Event(), asyncio.get_running_loop()
        robot._wake = lambda: loop.call_soon_threadsafe(changed.set)
        robot.hear()
        ends_at = loop.time() + wait_s
        while True:
            message = robot.next_message()
            if message is not None and message_tag(message) != seen:
                return Response(encode_message(message), media_type="application/json")
            left = ends_at - loop.time()
            if left <= 0 or robot._closed:
                return Response(status_code=204)
            changed.clear()
            try:
                await asyncio.wait_for(changed.wait(), min(left, 1.0))
            except TimeoutError:
                if await request.is_disconnected():
                    return Response(status_code=204)
                robot.hear()

    async def _receive(self, request: "Request") -> "Response":
        robot = self._robot(request)
        robot.hear()
        body = await _body(request)
        try:
            return _answer(200, receipt=robot.receive(body))
        except RobotError as error:
            return _answer(400, error=str(error))

    def _robot(self, request: "Request") -> RestRobot:
        from starlette.exceptions import HTTPException

        kind, _, given = request.headers.get("authorization", "").partition(" ")
        name = request.path_params["name"]
        # Every token is compared, so that time tells nothing about them, nor about which names exist.
        matching = [known for known, token in self._tokens.items() if _equal(token, given)]
        if kind.lower() != "bearer" or not matching:
            raise HTTPException(401, headers={"WWW-Authenticate": "Bearer"})
        if matching != [name]:
            raise HTTPException(403)
        return self.robots[name]


def _answer(status: int, **content: object) -> "Response":
    from starlette.responses import JSONResponse

    return JSONResponse(content, status_code=status)


def _equal(token: str, given: str) -> bool:
    return hmac.compare_digest(token.encode(), given.encode("utf-8", "surrogateescape"))


def _seconds(text: str) -> float:
    from starlette.exceptions import HTTPException

    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not seconds >= 0:
        raise HTTPException(400, "wait_s must be a number of seconds")
    return min(seconds, _MAX_WAIT_S)


async def _body(request: "Request") -> bytes:
    from starlette.exceptions import HTTPException
    from starlette.requests import ClientDisconnect

    body = b""
    try:
        async with asyncio.timeout(_BODY_TIMEOUT_S):
            async for chunk in request.stream():
                body += chunk
                if len(body) > MAX_BYTES:
                    raise HTTPException(413)
    except TimeoutError:
        raise HTTPException(408) from None
    except ClientDisconnect:
        raise HTTPException(400) from None
    return body

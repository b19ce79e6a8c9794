"""What a simulated participant needs of a browser: a connection that is kept, cookies, redirects.

A thousand of them share a machine with the server that they test; this takes a twentieth of the processor
time of a general HTTP library.
"""

import asyncio
import json
import ssl
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, cast
from urllib.parse import urlencode, urljoin, urlsplit

import httptools

_TIMEOUT_S = 60
_MOST_REDIRECTS = 5


@dataclass
class Answer:
    """What a server answered; header names are lower case."""

    status: int = 0
    headers: list[tuple[str, str]] = field(default_factory=list)
    body: bytes = b""

    @property
    def text(self) -> str:
        """The body as text."""
        return self.body.decode("utf-8", "replace")

    def json(self) -> dict[str, Any]:
        """Return the JSON object that the body holds."""
        return dict(json.loads(self.body))


class _Connection(asyncio.Protocol):
    """A connection that carries one request at a time."""

    transport: asyncio.Transport

    def __init__(self) -> None:
        self.is_open = False
        self._answered: asyncio.Future[Answer] | None = None

    async def ask(self, request: bytes) -> Answer:
        """Send a request and wait for the answer."""
        self._parser = httptools.HttpResponseParser(self)
        self._answer, self._parts = Answer(), list[bytes]()
        self._answered = asyncio.get_running_loop().create_future()
        self.transport.write(request)
        try:
            return await self._answered
        except asyncio.CancelledError:
            self._fail("nobody waits for the answer")  # nor may it be taken for the next request's
            raise

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport, self.is_open = cast("asyncio.Transport", transport), True

    def connection_lost(self, _: Exception | None) -> None:
        self._fail("the connection is lost")

    def data_received(self, data: bytes) -> None:
        if self._answered is None or self._answered.done():
            self._fail("the server speaks unasked")
            return
        try:
            self._parser.feed_data(data)
        except httptools.HttpParserError:
            self._fail("the server does not speak HTTP")

    def on_header(self, name: bytes, value: bytes) -> None:
        self._answer.headers.append((name.decode("latin-1").lower(), value.decode("latin-1")))

    def on_body(self, body: bytes) -> None:
        self._parts.append(body)

    def on_message_complete(self) -> None:
        self._answer.status, self._answer.body = self._parser.get_status_code(), b"".join(self._parts)
        self.is_open = self.is_open and self._parser.should_keep_alive()
        if self._answered is not None and not self._answered.done():
            self._answered.set_result(self._answer)

    def _fail(self, problem: str) -> None:
        self.is_open = False
        self.transport.close()
        if self._answered is not None and not self._answered.done():
            self._answered.set_exception(ConnectionError(problem))


class Client:
    """Talks to one server.

    Parameters
    ----------
    link
        Its address, with ``http`` or ``https``.
    """

    def __init__(self, link: str) -> None:
        self.cookies: dict[str, str] = {}
        self._link = link
        self._connection: _Connection | None = None

    async def request(
        self,
        method: str,
        path: str,
        *,
        params: Mapping[str, str] | None = None,
        data: Mapping[str, str] | None = None,
        json: object = None,
        headers: Mapping[str, str] | None = None,
    ) -> Answer:
        """Send a request, and follow where it leads; ``data`` is a form, ``json`` a value.

        Raises
        ------
        OSError
            If there is no answer.
        """
        target = f"{path}?{urlencode(params)}" if params else path
        kind, body = _encode(data, json)
        async with asyncio.timeout(_TIMEOUT_S):
            answer = await self._ask(method, target, {**(headers or {}), **kind}, body)
            for _ in range(_MOST_REDIRECTS):
                onward = next((value for name, value in answer.headers if name == "location"), None)
                if onward is None or not 300 <= answer.status < 400:
                    break
                place = urlsplit(urljoin(self._link, onward))
                target = place.path + (f"?{place.query}" if place.query else "")
                answer = await self._ask("GET", target, {}, b"")
        return answer

    def close(self) -> None:
        """Close the connection."""
        if self._connection is not None:
            self._connection.transport.close()

    async def _ask(self, method: str, target: str, headers: Mapping[str, str], body: bytes) -> Answer:
        place = urlsplit(self._link)
        lines = [f"{method} {target} HTTP/1.1", f"host: {place.netloc}", f"content-length: {len(body)}"]
        lines += [f"{name}: {value}" for name, value in headers.items()]
        if self.cookies:
            lines.append("cookie: " + "; ".join(f"{name}={value}" for name, value in self.cookies.items()))
        if self._connection is None or not self._connection.is_open:
            self.close()
            loop, is_safe = asyncio.get_running_loop(), place.scheme == "https"
            _, self._connection = await loop.create_connection(
                _Connection,
                place.hostname or "",
                place.port or (443 if is_safe else 80),
                ssl=ssl.create_default_context() if is_safe else None,
            )
        answer = await self._connection.ask("\r\n".join([*lines, "", ""]).encode("latin-1") + body)
        for name, value in answer.headers:
            if name == "set-cookie":
                cookie, _, content = value.split(";", 1)[0].partition("=")
                self.cookies[cookie] = content
        return answer


def _encode(data: Mapping[str, str] | None, value: object) -> tuple[dict[str, str], bytes]:
    """Return a body with the header that says what it is."""
    if value is not None:
        return {"content-type": "application/json"}, json.dumps(value).encode()
    if data is not None:
        return {"content-type": "application/x-www-form-urlencoded"}, urlencode(data).encode()
    return {}, b""

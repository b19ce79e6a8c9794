"""Who may do what: signed names, tokens against forged requests, and limits on what can be sent."""

import hashlib
import hmac
import math
import secrets
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from itsdangerous import BadSignature, URLSafeSerializer, URLSafeTimedSerializer
from starlette.datastructures import Headers
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

MAX_BODY_BYTES = 64 * 1024
SESSION_COOKIE, ADMIN_COOKIE = "study", "study-admin"
ADMIN_HOURS = 12

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}
Refuse: TypeAlias = Callable[[str, str, int, Mapping[str, str]], Response]
"""Answers a request for a path that is refused: why, with which status and headers."""
_RAW_HEADERS = [(name.lower().encode(), value.encode()) for name, value in HEADERS.items()]


@dataclass(frozen=True, slots=True)
class Keys:
    """Signs what travels through the participant's browser.

    Parameters
    ----------
    secret
        Known to the server alone.
    """

    secret: str = field(repr=False)

    def sign(self, what: str, value: object) -> str:
        """Sign a value for one purpose.

        Examples
        --------
        >>> keys = Keys("secret")
        >>> keys.read("session", keys.sign("session", "s1")), keys.read("admin", keys.sign("session", "s1"))
        ('s1', None)
        """
        return str(URLSafeSerializer(self.secret, salt=what).dumps(value))

    def read(self, what: str, signed: str | None) -> object:
        """Return a signed value, or None if it was not signed for this purpose."""
        try:
            return URLSafeSerializer(self.secret, salt=what).loads(signed or "")
        except BadSignature:
            return None

    def sign_admin(self, password_hash: str) -> str:
        """Sign in: valid for some hours, and as long as the password is not changed."""
        serializer = URLSafeTimedSerializer(self.secret, salt="admin")
        return str(serializer.dumps(hashlib.sha256(password_hash.encode()).hexdigest()))

    def is_admin(self, signed: str | None, password_hash: str) -> bool:
        """Tell whether a cookie is that of a researcher who is signed in."""
        serializer = URLSafeTimedSerializer(self.secret, salt="admin")
        try:
            value = serializer.loads(signed or "", max_age=ADMIN_HOURS * 3600)
        except BadSignature:
            return False
        return bool(value == hashlib.sha256(password_hash.encode()).hexdigest())

    def token(self, owner: str) -> str:
        """Return the token that forms and scripts of this owner's pages must send back."""
        return hmac.digest(self.secret.encode(), f"csrf:{owner}".encode(), "sha256").hex()

    def is_token(self, owner: str, token: str | None) -> bool:
        """Tell whether a token is the owner's."""
        return hmac.compare_digest(self.token(owner).encode(), (token or "").encode())


def hash_password(password: str, salt: bytes | None = None) -> str:
    """Hash a password with scrypt and a salt.

    Examples
    --------
    >>> is_password("open", hash_password("open")), is_password("wrong", hash_password("open"))
    (True, False)
    """
    salt = salt or secrets.token_bytes(16)
    digest = hashlib.scrypt(password.encode(), salt=salt, n=2**14, r=8, p=1)
    return f"{salt.hex()}:{digest.hex()}"


def is_password(password: str, hashed: str) -> bool:
    """Tell whether a password is the one that was hashed."""
    salt = bytes.fromhex(hashed.split(":", maxsplit=1)[0])
    return hmac.compare_digest(hash_password(password, salt), hashed)


@dataclass
class Limiter:
    """A bucket of tokens for everybody: so many at once, and so many a second in the long run.

    Parameters
    ----------
    per_s, burst
        Tokens a second, and tokens of a full bucket.
    clock
        Seconds.

    Examples
    --------
    >>> limiter = Limiter(per_s=1, burst=2, clock=lambda: 0.0)
    >>> [limiter.allows("a") for _ in range(3)], limiter.allows("b")
    ([True, True, False], True)
    """

    per_s: float
    burst: float
    clock: Callable[[], float] = time.monotonic
    most_keys: int = 50_000
    _buckets: "OrderedDict[str, tuple[float, float]]" = field(default_factory=OrderedDict, repr=False)

    def allows(self, key: str) -> bool:
        """Take a token, if there is one."""
        now = self.clock()
        level, then = self._buckets.pop(key, (self.burst, now))
        level = min(self.burst, level + (now - then) * self.per_s)
        self._buckets[key] = (level - 1 if level >= 1 else level, now)
        if len(self._buckets) > self.most_keys:
            self._buckets.popitem(last=False)  # whoever was quiet longest had a full bucket anyway
        return level >= 1

    @property
    def refill_s(self) -> int:
        """Seconds after which there is a token again, whole ones."""
        return math.ceil(1 / self.per_s)


class Guard:
    """Middleware: limits bodies and floods, and sets the headers that keep browsers strict.

    A flood is counted by session, and without one by network address, which is kept in memory only.
    """

    def __init__(self, app: ASGIApp, session: Limiter, address: Limiter, refuse: Refuse) -> None:
        self.app, self.session, self.address, self.refuse = app, session, address, refuse

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def send_strictly(message: Message) -> None:
            if message["type"] == "http.response.start":
                given = {name.lower() for name, _ in message["headers"]}
                strict = [header for header in _RAW_HEADERS if header[0] not in given]
                message = {**message, "headers": [*message["headers"], *strict]}
            await send(message)

        limiter, key = self._bucket(scope)
        if scope["method"] not in {"GET", "HEAD"} and not limiter.allows(key):
            wait = {"Retry-After": str(limiter.refill_s)}
            refusal = self.refuse(scope["path"], "too many requests: please wait a moment", 429, wait)
            await refusal(scope, receive, send_strictly)
            return
        body, is_whole = b"", False
        while not is_whole:
            message = await receive()
            if message["type"] == "http.disconnect":
                return
            body += message.get("body", b"")
            is_whole = not message.get("more_body", False)
            if len(body) > MAX_BODY_BYTES:
                refusal = self.refuse(scope["path"], "that is too much to be sent at once", 413, {})
                await refusal(scope, receive, send_strictly)
                return
        messages = iter([{"type": "http.request", "body": body, "more_body": False}])

        async def receive_body() -> Message:
            return next(messages, None) or await receive()

        await self.app(scope, receive_body, send_strictly)

    def _bucket(self, scope: Scope) -> tuple[Limiter, str]:
        """Return by what a request is counted."""
        cookie = _cookie(Headers(scope=scope).get("cookie", ""), SESSION_COOKIE)
        if cookie and scope["path"].startswith(("/api/", "/session")):
            return self.session, hashlib.sha256(cookie.encode()).hexdigest()
        return self.address, scope["client"][0] if scope.get("client") else ""


def _cookie(header: str, name: str) -> str:
    pairs: Iterable[list[str]] = (part.strip().split("=", 1) for part in header.split(";"))
    return next((pair[1] for pair in pairs if len(pair) == 2 and pair[0] == name), "")

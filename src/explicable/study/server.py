"""What all routes share: the study's parts, jobs on the database, and whose session a request belongs to."""

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

from fastapi import HTTPException, Request

from explicable.study.conduct import Conduct
from explicable.study.materials import Materials
from explicable.study.pages import Pages
from explicable.study.security import SESSION_COOKIE, Keys
from explicable.study.store import Store
from explicable.study.transaction import Transaction
from explicable.study.view import Views
from explicable.study.watch import Watch

T = TypeVar("T")

READING = ["GET", "HEAD"]
"""Methods of what is only read: FastAPI, unlike Starlette below it, does not answer HEAD by itself."""
_MOST_COOKIES = 10_000


@dataclass(frozen=True)
class Server:
    """What the routes share."""

    materials: Materials
    store: Store
    keys: Keys
    conduct: Conduct
    pages: Pages
    views: Views
    closing: threading.Event

    @cached_property
    def watch(self) -> Watch:
        """What tells open pages of changes."""
        return Watch(lambda since: self.read(lambda tx: tx.changed_since(since)), self.closing.is_set)

    @cached_property
    def named_session(self) -> Callable[[str | None], str | None]:
        """Returns the session that a cookie names, if it was signed here; remembers the latest."""

        @lru_cache(maxsize=_MOST_COOKIES)
        def named(cookie: str | None) -> str | None:
            session = self.keys.read("session", cookie)
            return session if isinstance(session, str) else None

        return named

    @cached_property
    def is_token(self) -> Callable[[str, str | None], bool]:
        """Tells whether a token is its owner's; remembers the latest answers."""
        return lru_cache(maxsize=_MOST_COOKIES)(self.keys.is_token)

    async def write(self, job: Callable[[Transaction], T]) -> T:
        """Let a job run that may write; done when what it did is on the disk."""
        loop = asyncio.get_running_loop()
        answer: asyncio.Future[T] = loop.create_future()

        def tell(result: T, error: BaseException | None) -> None:
            with suppress(RuntimeError):  # the loop has ended: nobody waits any more
                loop.call_soon_threadsafe(_settle, answer, result, error)

        self.store.writer.submit(job, tell, lambda: not answer.cancelled())
        return await answer

    async def read(self, job: Callable[[Transaction], T]) -> T:
        """Run a job that only reads."""
        return await asyncio.to_thread(self.store.read, job)

    def session(self, request: Request) -> str:
        """Return the session that a cookie names.

        Raises
        ------
        HTTPException
            401 without a cookie that was signed here.
        """
        session = self.named_session(request.cookies.get(SESSION_COOKIE))
        if session is None:
            raise HTTPException(401, "no session: please open the link of the study again")
        return session

    def own_session(self, request: Request, token: str | None) -> str:
        """Return the session, where the request comes from one of its own pages.

        Raises
        ------
        HTTPException
            403 if the token does not belong to the session.
        """
        session = self.session(request)
        self.require_token(session, token)
        return session

    def require_token(self, owner: str, token: str | None) -> None:
        """Refuse a request that does not come from one of the owner's pages.

        Raises
        ------
        HTTPException
            403 if the token is not the owner's.
        """
        if not self.is_token(owner, token):
            raise HTTPException(403, "this request does not come from a page of the study")


def _settle(answer: "asyncio.Future[T]", result: T, error: BaseException | None) -> None:
    if answer.done():  # whoever asked has gone
        return
    if error is None:
        answer.set_result(result)
    else:
        answer.set_exception(error)

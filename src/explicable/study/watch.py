"""Tells open pages when their session has gone on elsewhere: one question a second for all of them."""

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass, field

from explicable.study.writer import UnavailableError

INTERVAL_S = 1.0
_OVERLAP_S = 5.0
"""How far each question reaches back: transactions and the clocks of several workers may lag a little."""

Ask = Callable[[float], Awaitable[list[tuple[str, int]]]]
"""Returns the sessions, with their revisions, that have been seen since a moment."""


@dataclass
class Watch:
    """Watches the sessions whose pages are open.

    Parameters
    ----------
    ask
        Asks the database.
    is_closing
        Tells whether the server is about to stop, which ends all streams.
    """

    ask: Ask
    is_closing: Callable[[], bool]
    revisions: dict[str, int] = field(default_factory=dict)
    num_listeners: int = 0

    async def run(self) -> None:
        """Ask for what has changed, again and again, while anybody listens."""
        while True:
            await asyncio.sleep(INTERVAL_S)
            if self.num_listeners:
                since = time.time() - INTERVAL_S - _OVERLAP_S
                try:
                    self.revisions = dict(await self.ask(since))
                except UnavailableError:
                    continue  # whoever acts is told so; who only listens hears it a second later

    async def listen(self, session: str, is_gone: Callable[[], Awaitable[bool]]) -> AsyncIterator[str]:
        """Yield a server-sent event whenever the session's revision has changed."""
        self.num_listeners += 1
        told = None
        try:
            while not self.is_closing() and not await is_gone():
                revision = self.revisions.get(session, told)
                if revision != told:
                    told = revision
                    yield f"data: {told}\n\n"
                await asyncio.sleep(INTERVAL_S / 2)
        finally:
            self.num_listeners -= 1

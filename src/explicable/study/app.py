"""The web application: all that a study answers over HTTP, put together."""

import asyncio
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib import metadata
from pathlib import Path

from fastapi import FastAPI
from fastapi.staticfiles import StaticFiles
from starlette.types import ASGIApp

from explicable.study.admin import Researchers
from explicable.study.conduct import Conduct
from explicable.study.interface import FrontDoor, Interface
from explicable.study.pages import Pages
from explicable.study.refusals import Refusals
from explicable.study.security import Guard, Keys, Limiter
from explicable.study.server import Server
from explicable.study.store import Store
from explicable.study.view import Views
from explicable.study.visits import Visits

HERE = Path(__file__).parent


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
    rate, refusals = 1e9 if trusts_floods else 1.0, Refusals(pages)
    Interface(server).add_to(app)
    app.mount("/static", StaticFiles(directory=HERE / "static"))
    refusals.add_to(app)
    app.include_router(Visits(server).routes())
    app.include_router(Researchers(server, Limiter(0.2 * rate, 10 * rate)).routes())
    session, address = Limiter(20 * rate, 60 * rate), Limiter(20 * rate, 200 * rate)
    return Guard(FrontDoor(app), session=session, address=address, refuse=refusals.answer)

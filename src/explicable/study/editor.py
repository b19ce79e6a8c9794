"""The map editor: paint cells, see both views at once, and be told what is wrong before saving."""

import re
from typing import TYPE_CHECKING, Annotated

from fastapi import APIRouter, Header, HTTPException, Request
from fastapi.responses import Response
from pydantic import BaseModel, Field

from explicable.errors import MapError
from explicable.first_response import World, format_map, read_map, render
from explicable.model.files import write_whole
from explicable.study.server import READING, Server

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

NAME = re.compile(r"[a-z0-9][a-z0-9-]{0,40}")
LARGEST = 20
"""Most rows, and most columns, that can be painted."""

Rows = Annotated[
    list[Annotated[str, Field(min_length=1, max_length=LARGEST)]], Field(min_length=1, max_length=LARGEST)
]


class Painting(BaseModel):
    """What has been painted, in the characters of the map format."""

    rows: Rows


class Named(Painting):
    """A painting to be saved."""

    name: Annotated[str, Field(pattern=rf"^{NAME.pattern}$")]


class Seen(BaseModel):
    """Both views of a painting, or what is wrong with it; rows and columns count from 1."""

    error: str | None = None
    row: int | None = None
    column: int | None = None
    human: str | None = None
    robot: str | None = None


class Saved(BaseModel):
    """Where a map has been saved, relative to the study's folder."""

    map: str


def routes(server: Server, require: "Callable[[Request], Awaitable[str]]") -> APIRouter:
    """Return the editor's routes; ``require`` returns the owner of tokens, or sends strangers away."""
    router = APIRouter(prefix="/maps", include_in_schema=False)
    folder = server.materials.folder / "maps"

    async def require_own_page(request: Request, token: str) -> None:
        server.require_token(await require(request), token)

    @router.api_route("", methods=READING)
    async def editor(request: Request) -> Response:
        owner = await require(request)
        names = sorted(path.stem for path in folder.glob("*.map") if NAME.fullmatch(path.stem))
        chosen = request.query_params.get("from", "")
        rows = _blank()
        if chosen in names:
            world = read_map(folder / f"{chosen}.map")
            if max(world.height, world.width) <= LARGEST:
                rows = list(world.rows)
        token = server.keys.token(owner)
        return server.pages.admin(
            "editor.html", token=token, names=names, rows=rows, chosen=chosen, largest=LARGEST
        )

    @router.post("/look")
    async def look(request: Request, painting: Painting, x_token: Annotated[str, Header()] = "") -> Seen:
        await require_own_page(request, x_token)
        return see(painting.rows)

    @router.post("/save")
    async def save(request: Request, named: Named, x_token: Annotated[str, Header()] = "") -> Saved:
        await require_own_page(request, x_token)
        try:
            world = World(tuple(named.rows), {"name": named.name})
        except MapError as error:
            raise HTTPException(422, str(error)) from error
        path = folder / f"{named.name}.map"
        if path.exists():  # a map that people have played must stay what it was
            raise HTTPException(409, f"there is a map {named.name!r} already: please choose another name")
        write_whole(path, format_map(world))
        return Saved(map=f"maps/{named.name}.map")

    return router


def see(rows: list[str]) -> Seen:
    """Draw both views of what has been painted, or say what is wrong.

    Examples
    --------
    >>> see(["@x*"]).error
    'the marked room c-0-2 cannot be reached by any robot'
    """
    try:
        world = World(tuple(rows))
    except MapError as error:
        return Seen(error=error.message, row=error.line, column=error.column)
    return Seen(human=render(world, "human"), robot=render(world, "robot"))


def _blank() -> list[str]:
    """Return a walled map of the size of the paper's."""
    return ["#" * 8, *["#......#"] * 6, "#" * 8]

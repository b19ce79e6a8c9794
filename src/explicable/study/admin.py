"""The researcher's pages: how far the study has come, who is at it, what the labels are worth."""

import asyncio
import secrets
import shutil
import tempfile
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from fastapi import APIRouter, HTTPException, Request
from fastapi.responses import RedirectResponse, Response, StreamingResponse

from explicable.study import editor
from explicable.study.enrolment import free_places
from explicable.study.folder import read_setting
from explicable.study.forms import read_form
from explicable.study.ledger import OPEN_STAGES
from explicable.study.records import live_sessions
from explicable.study.security import ADMIN_COOKIE, ADMIN_HOURS, Limiter, is_password
from explicable.study.summary import summarise
from explicable.study.transaction import Transaction

if TYPE_CHECKING:
    from explicable.study.server import Server

LIVE_S = 120
"""Seconds since the last sign of life up to which a session counts as live."""
_CHUNK = 64 * 1024


def routes(server: "Server", tries: Limiter) -> APIRouter:
    """Return the routes of the researcher's pages; ``tries`` limits how fast passwords can be tried."""
    router = APIRouter(prefix="/admin", include_in_schema=False)
    pages, keys, materials = server.pages, server.keys, server.materials

    async def password_hash() -> str:
        return await server.read(lambda tx: read_setting(tx, "admin") or "")

    async def require(request: Request) -> str:
        """Return the owner's name for tokens, or send whoever is not signed in away."""
        cookie, hashed = request.cookies.get(ADMIN_COOKIE), await password_hash()
        if not keys.is_admin(cookie, hashed):
            raise HTTPException(303, "please sign in", {"Location": "/admin/login"})
        return f"admin:{cookie}"

    @router.get("/login")
    async def login_page() -> Response:
        return pages.admin("login.html", is_wrong=False)

    @router.post("/login")
    async def login(request: Request) -> Response:
        form = await read_form(request)
        if not tries.allows(request.client.host if request.client else ""):
            raise HTTPException(429, "too many tries: please wait a minute")
        hashed = await password_hash()
        if not hashed or not await asyncio.to_thread(is_password, form.get("password", "")[:200], hashed):
            return pages.admin("login.html", 403, is_wrong=True)
        response = RedirectResponse("/admin", 303)
        response.set_cookie(
            ADMIN_COOKIE,
            keys.sign_admin(hashed),
            max_age=ADMIN_HOURS * 3600,
            path="/admin",
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
        )
        return response

    @router.post("/logout")
    async def logout(request: Request) -> Response:
        owner, form = await require(request), await read_form(request)
        if not keys.is_token(owner, form.get("token")):
            raise HTTPException(403, "this request does not come from a page of the study")
        response = RedirectResponse("/admin/login", 303)
        response.delete_cookie(ADMIN_COOKIE, path="/admin")
        return response

    @router.get("")
    async def overview(request: Request) -> Response:
        owner = await require(request)
        origin = "simulated" if request.query_params.get("origin") == "simulated" else "person"
        now = time.time()
        await server.write(lambda tx: free_places(materials, tx, now))
        summary = await server.read(lambda tx: summarise(tx, materials, origin))
        live = await server.read(lambda tx: live_sessions(tx, now - LIVE_S, OPEN_STAGES))
        return pages.admin(
            "admin.html",
            token=keys.token(owner),
            origin=origin,
            summary=summary,
            live=live,
            now=now,
            hash=materials.hash,
        )

    @router.post("/download")
    async def download(request: Request) -> Response:
        owner, form = await require(request), await read_form(request)
        if not keys.is_token(owner, form.get("token")):
            raise HTTPException(403, "this request does not come from a page of the study")
        folder = Path(await asyncio.to_thread(tempfile.mkdtemp, prefix="explicable-"))
        try:
            path = await server.read(lambda tx: _zip_export(tx, server, folder))
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        name = f"study-{time.strftime('%Y%m%d-%H%M%S', time.gmtime())}-{secrets.token_hex(2)}.zip"
        headers = {"Content-Disposition": f'attachment; filename="{name}"'}
        return StreamingResponse(_sent_then_removed(path, folder), 200, headers, "application/zip")

    router.include_router(editor.routes(server, require), prefix="")
    return router


def _zip_export(tx: Transaction, server: "Server", folder: Path) -> Path:
    from explicable.study.export import export

    export(tx, server.materials, folder / "data")
    path = folder / "data.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted((folder / "data").rglob("*")):
            archive.write(file, file.relative_to(folder))
    return path


def _sent_then_removed(path: Path, folder: Path) -> Iterator[bytes]:
    try:
        with path.open("rb") as file:
            while chunk := file.read(_CHUNK):
                yield chunk
    finally:
        shutil.rmtree(folder, ignore_errors=True)

"""The researcher's pages: how far the study has come, who is at it, what the labels are worth."""

import asyncio
import secrets
import shutil
import tempfile
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fastapi import APIRouter, HTTPException, Request
from fastapi.responses import RedirectResponse, Response, StreamingResponse

from explicable.study import editor
from explicable.study.enrolment import free_places
from explicable.study.folder import read_setting
from explicable.study.forms import read_form
from explicable.study.ledger import OPEN_STAGES
from explicable.study.records import live_sessions
from explicable.study.security import ADMIN_COOKIE, ADMIN_HOURS, Limiter, is_password
from explicable.study.server import READING, Server
from explicable.study.summary import summarise
from explicable.study.transaction import Transaction

LIVE_S = 120
"""Seconds since the last sign of life up to which a session counts as live."""
_CHUNK = 64 * 1024


@dataclass(frozen=True)
class Researchers:
    """Answers what researchers ask for.

    Parameters
    ----------
    server
        What all routes share.
    tries
        Limits how fast passwords can be tried.
    """

    server: Server
    tries: Limiter

    def routes(self) -> APIRouter:
        """Return what is answered by which function."""
        routes = APIRouter(prefix="/admin", include_in_schema=False)
        routes.add_api_route("", self.overview, methods=READING)
        routes.add_api_route("/login", self.login_page, methods=READING)
        routes.add_api_route("/login", self.login, methods=["POST"])
        routes.add_api_route("/logout", self.logout, methods=["POST"])
        routes.add_api_route("/download", self.download, methods=["POST"])
        routes.include_router(editor.routes(self.server, self.require))
        return routes

    async def require(self, request: Request) -> str:
        """Return the owner's name for tokens, or send whoever is not signed in away.

        Raises
        ------
        HTTPException
            303 to the page for signing in.
        """
        cookie, hashed = request.cookies.get(ADMIN_COOKIE), await self._password_hash()
        if not self.server.keys.is_admin(cookie, hashed):
            raise HTTPException(303, "please sign in", {"Location": "/admin/login"})
        return f"admin:{cookie}"

    async def login_page(self) -> Response:
        """Ask for the password."""
        return self.server.pages.admin("login.html", is_wrong=False)

    async def login(self, request: Request) -> Response:
        """Sign in whoever knows the password."""
        form = await read_form(request)
        if not self.tries.allows(request.client.host if request.client else ""):
            wait = {"Retry-After": str(self.tries.refill_s)}
            raise HTTPException(429, "too many tries: please wait a moment", wait)
        hashed = await self._password_hash()
        if not hashed or not await asyncio.to_thread(is_password, form.get("password", "")[:200], hashed):
            return self.server.pages.admin("login.html", 403, is_wrong=True)
        response = RedirectResponse("/admin", 303)
        response.set_cookie(
            ADMIN_COOKIE,
            self.server.keys.sign_admin(hashed),
            max_age=ADMIN_HOURS * 3600,
            path="/admin",
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
        )
        return response

    async def logout(self, request: Request) -> Response:
        """Forget, in this browser, who was signed in."""
        await self._require_own_page(request)
        response = RedirectResponse("/admin/login", 303)
        response.delete_cookie(ADMIN_COOKIE, path="/admin")
        return response

    async def overview(self, request: Request) -> Response:
        """Show how the study goes."""
        owner, server, now = await self.require(request), self.server, time.time()
        origin = "simulated" if request.query_params.get("origin") == "simulated" else "person"
        await server.write(lambda tx: free_places(server.materials, tx, now))
        summary = await server.read(lambda tx: summarise(tx, server.materials, origin))
        live = await server.read(lambda tx: live_sessions(tx, now - LIVE_S, OPEN_STAGES))
        return server.pages.admin(
            "admin.html",
            token=server.keys.token(owner),
            origin=origin,
            summary=summary,
            live=live,
            now=now,
            hash=server.materials.hash,
        )

    async def download(self, request: Request) -> Response:
        """Send the data set."""
        await self._require_own_page(request)
        folder = Path(await asyncio.to_thread(tempfile.mkdtemp, prefix="explicable-"))
        try:
            path = await self.server.read(lambda tx: _zip_export(tx, self.server, folder))
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        name = f"study-{time.strftime('%Y%m%d-%H%M%S', time.gmtime())}-{secrets.token_hex(2)}.zip"
        headers = {"Content-Disposition": f'attachment; filename="{name}"'}
        return StreamingResponse(_sent_then_removed(path, folder), 200, headers, "application/zip")

    async def _password_hash(self) -> str:
        return await self.server.read(lambda tx: read_setting(tx, "admin") or "")

    async def _require_own_page(self, request: Request) -> None:
        owner, form = await self.require(request), await read_form(request)
        self.server.require_token(owner, form.get("token"))


def _zip_export(tx: Transaction, server: Server, folder: Path) -> Path:
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

"""What a request that is not carried out is answered: a page for people, JSON for scripts."""

from collections.abc import Mapping
from dataclasses import dataclass

from fastapi import FastAPI
from fastapi import Request as HTTPRequest
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, RedirectResponse, Response
from starlette.exceptions import HTTPException

from explicable.errors import InputError
from explicable.study.conduct import UnknownSessionError
from explicable.study.interface import Problem
from explicable.study.pages import Pages
from explicable.study.protocol import ConflictError
from explicable.study.writer import UnavailableError

_SCRIPTS = ("/api/", "/admin/maps/")
_SAID_OTHERWISE = {
    400: "the request could not be read",
    404: "there is no such page",
    405: "there is no such page",
}
"""In the place of what the web framework says."""


@dataclass(frozen=True)
class Refusals:
    """Answers what is not carried out: participants in their language, researchers in English."""

    pages: Pages

    def answer(
        self, path: str, message: str, status: int, headers: Mapping[str, str] | None = None
    ) -> Response:
        """Say why a request for a path is refused."""
        own = self.pages.language_of(path)
        if path.startswith(_SCRIPTS):
            return JSONResponse(Problem(error=own.text(message)).model_dump(), status, headers)
        page = self.pages.problem(message, status, own)
        page.headers.update(headers or {})
        return page

    def add_to(self, app: FastAPI) -> None:
        """Let an application answer so whatever its routes raise."""

        @app.exception_handler(ConflictError)
        async def conflict(request: HTTPRequest, error: ConflictError) -> Response:
            status = 401 if isinstance(error, UnknownSessionError) else 409
            return self.answer(request.url.path, str(error), status)

        @app.exception_handler(UnavailableError)
        async def unavailable(request: HTTPRequest, error: UnavailableError) -> Response:
            return self.answer(request.url.path, str(error), 503, {"Retry-After": "1"})

        @app.exception_handler(InputError)
        async def bad_input(request: HTTPRequest, error: InputError) -> Response:
            return self.answer(request.url.path, error.message, 422)

        @app.exception_handler(RequestValidationError)
        async def misshapen(request: HTTPRequest, error: RequestValidationError) -> Response:
            first = error.errors()[0]
            place = ".".join(str(part) for part in first["loc"])
            return self.answer(request.url.path, f"{place}: {first['msg']}", 422)

        @app.exception_handler(HTTPException)
        async def refused(request: HTTPRequest, error: HTTPException) -> Response:
            if error.status_code == 303 and error.headers:
                return RedirectResponse(error.headers["Location"], 303)
            message = _SAID_OTHERWISE.get(error.status_code, str(error.detail))
            return self.answer(request.url.path, message, error.status_code, error.headers)

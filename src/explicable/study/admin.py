"""The researcher's pages."""

from typing import TYPE_CHECKING

from fastapi import APIRouter

from explicable.study.security import Limiter

if TYPE_CHECKING:
    from explicable.study.app import Server


def routes(server: "Server", login: Limiter) -> APIRouter:
    """Return the routes of the researcher's pages; ``login`` limits how fast passwords can be tried."""
    del server, login
    return APIRouter(prefix="/admin", include_in_schema=False)

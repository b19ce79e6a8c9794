"""Run a study's server: one process, or several that share a port."""

import functools
import gc
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from explicable.errors import InputError, UsageError
from explicable.study.app import create_app
from explicable.study.folder import open_database
from explicable.study.materials import read_materials
from explicable.study.recruitment import link_template
from explicable.study.store import sqlite_url

if TYPE_CHECKING:
    import uvicorn

GRACE_S = 2
"""Seconds that requests under way get when the server is stopped."""
KEEP_S = 65
"""Seconds for which an idle connection is kept: people think for longer than uvicorn's five."""
START_S = 120
"""Seconds after which a worker that does not answer is replaced: on a busy machine it takes long to start."""


@dataclass(frozen=True, slots=True)
class Announcement:
    """What the researcher is told when the server starts."""

    link: str
    recruitment_link: str | None
    new_password: str | None


class Server:
    """A study's server, bound to its port but not yet running.

    Parameters
    ----------
    folder
        The study's folder.
    host, port
        Where to listen; port 0 takes any that is free.
    database
        As SQLAlchemy writes it; by default the file in the study's folder.
    workers
        Number of processes.
    renews_password
        Whether to make a new password for the researcher.
    """

    def __init__(
        self,
        folder: Path,
        *,
        host: str = "127.0.0.1",
        port: int = 8000,
        database: str | None = None,
        workers: int = 1,
        renews_password: bool = False,
        trusts_floods: bool = False,
    ) -> None:
        materials = read_materials(folder)
        materials.check()
        url = database or sqlite_url(folder.resolve())
        self._socket = _bind(host, port)  # before a password is made that nobody would be shown
        try:
            opened = open_database(url, materials.hash, renews_password=renews_password)
        except BaseException:
            self._socket.close()
            raise
        shown = f"[{host}]" if ":" in host else host
        link = f"http://{shown}:{self._socket.getsockname()[1]}/"
        platform = materials.study.recruitment.platform
        recruiting = None if platform == "plain" else link_template(platform, link)
        self.announcement = Announcement(link, recruiting, opened.new_password)
        self._workers = workers
        self._app = functools.partial(_create, folder.resolve(), url, trusts_floods=trusts_floods)

    @contextmanager
    def in_background(self) -> Iterator[str]:
        """Serve from a thread of this process while the block runs; yields the link.

        Raises
        ------
        InputError
            If the server does not start.
        """
        server = self._server()
        thread = threading.Thread(target=server.run, args=([self._socket],), daemon=True)
        thread.start()
        try:
            while not server.started and thread.is_alive():
                time.sleep(0.02)
            if not server.started:
                raise InputError("the study's server did not start")
            yield self.announcement.link
        finally:
            server.should_exit = True
            thread.join()
            self._socket.close()

    def run(self) -> None:
        """Serve until interrupted."""
        from uvicorn.supervisors import Multiprocess

        try:
            if self._workers > 1:
                Multiprocess(self._config(), sockets=[self._socket]).run()
            else:
                self._server().run(sockets=[self._socket])
        except KeyboardInterrupt:
            pass  # that is how it is stopped
        finally:
            self._socket.close()

    def _server(self) -> "uvicorn.Server":
        """Make a server that ends the streams to open pages before it waits for its connections."""
        import uvicorn

        closing = threading.Event()

        class EndingServer(uvicorn.Server):
            async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
                closing.set()
                await super().shutdown(sockets)

        return EndingServer(self._config(closing))

    def _config(self, closing: threading.Event | None = None) -> "uvicorn.Config":
        import uvicorn

        return uvicorn.Config(
            functools.partial(self._app, closing=closing),
            factory=True,
            workers=self._workers,
            log_level="warning",
            access_log=False,
            server_header=False,
            timeout_graceful_shutdown=GRACE_S,
            timeout_keep_alive=KEEP_S,
            timeout_worker_healthcheck=START_S,
        )


def _create(folder: Path, url: str, **options: Any) -> object:  # noqa: ANN401 (as `create_app` has them)
    app = create_app(folder, url, **options)
    gc.freeze()  # what is there for good need not be searched for garbage again and again
    return app


def _bind(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    bound = socket.socket(family)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        bound.bind((host, port))
    except socket.gaierror as error:
        bound.close()
        raise UsageError(f"there is no host {host!r}: {error.strerror}") from error
    except OSError as error:
        bound.close()
        raise InputError(f"{host}:{port} can't be listened on: {error.strerror}") from error
    bound.set_inheritable(True)
    return bound

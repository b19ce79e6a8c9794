"""The robot's end of the REST interface; small enough to be copied into any node."""

import http.client

from explicable.errors import RobotError
from explicable.execution.robots.messages import (
    MAX_BYTES,
    ReportMessage,
    decode_message,
    encode_message,
    message_tag,
)
from explicable.execution.robots.remote import RobotSide


class RestClient:
    """Pulls messages and pushes reports.

    Parameters
    ----------
    host, port, name, token
        The server, the robot, and its token.

    Attributes
    ----------
    side
        What has been ordered and answered.
    """

    def __init__(self, host: str, port: int, name: str, token: str, *, timeout_s: float = 60.0) -> None:
        self.side = RobotSide(name, self._post)
        self._address, self._timeout_s = (host, port), timeout_s
        self._path = f"/v1/robots/{name}"
        self._headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
        self._seen: str | None = None

    def pull(self, wait_s: float = 20.0) -> bool:
        """Wait for a message; then see ``side.order`` and ``side.cancelled``.

        Returns
        -------
        bool
            Whether a message came.

        Raises
        ------
        OSError
            If the server is out of reach; try again.
        RobotError
            If the server refuses.
        """
        seen = f"&seen={self._seen}" if self._seen else ""
        status, body = self._request("GET", f"{self._path}/next?wait_s={wait_s}{seen}", None)
        if status != 200:
            return False
        self._seen = message_tag(decode_message(body))
        self.side.receive(body)
        return True

    def _post(self, message: ReportMessage) -> None:
        try:
            self._request("POST", f"{self._path}/messages", encode_message(message))
        except OSError:
            self._seen = None  # the order will come again, and with it the answer goes again
            raise

    def _request(self, method: str, path: str, body: bytes | None) -> tuple[int, bytes]:
        connection = http.client.HTTPConnection(*self._address, timeout=self._timeout_s)
        try:
            connection.request(method, path, body, self._headers)
            response = connection.getresponse()
            content = response.read(MAX_BYTES + 1)
        except http.client.HTTPException as error:
            raise ConnectionError(f"the server's answer broke off ({error!r})") from error
        finally:
            connection.close()
        if response.status >= 400:
            raise RobotError(
                f"the server answers {response.status}: {content[:200].decode(errors='replace')}"
            )
        return response.status, content

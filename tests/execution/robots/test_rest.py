import http.client
import threading
from contextlib import contextmanager

import pytest
from rigs import FINISHES, HANGS, PATIENCE_S, STEPS, scripted_report

from explicable.errors import RobotError, UsageError
from explicable.execution.robots import Accepted, Failed, Finished, Order, Refused
from explicable.execution.robots.conformance import Rig, check
from explicable.execution.robots.messages import MAX_BYTES, ReportMessage, encode_message
from explicable.execution.robots.rest import RestServer
from explicable.execution.robots.rest_client import RestClient

TOKENS = {"r1": "a token of sixteen", "r2": "another of sixteen"}


@contextmanager
def driven(client):
    """A thread in which the robot pulls and answers as in the script."""
    stop = threading.Event()

    def drive():
        while not stop.is_set():
            if client.pull(0.2) and client.side.order:
                report = scripted_report(client.side.order)
                if client.side.cancelled:
                    report = Failed(client.side.order.number, "cancelled")
                if report:
                    client.side.report(report)

    thread = threading.Thread(target=drive)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def connect(server, name="r1"):
    client = RestClient(server.host, server.port, name, TOKENS[name])
    client.pull(0)
    return client


@contextmanager
def rig():
    with RestServer(TOKENS) as server, driven(connect(server)):
        yield Rig(server.robots["r1"], **STEPS)


def test_a_robot_that_pulls_over_http_conforms():
    assert check(rig) == ()


@pytest.fixture(scope="module")
def server():
    with RestServer(TOKENS) as server:
        yield server


def ask(server, method, path, body=None, **headers):
    connection = http.client.HTTPConnection(server.host, server.port, timeout=PATIENCE_S)
    connection.request(method, path, body, headers)
    response = connection.getresponse()
    status, text = response.status, response.read().decode()
    connection.close()
    return status, text


BEARER = {"Authorization": f"Bearer {TOKENS['r1']}"}


@pytest.mark.parametrize(
    ("path", "headers", "status"),
    [
        ("/v1/robots/r1", BEARER, 200),
        ("/v1/robots/r1", {}, 401),
        ("/v1/robots/r1", {"Authorization": "Bearer "}, 401),
        ("/v1/robots/r1", {"Authorization": "Bearer forged token, long"}, 401),
        ("/v1/robots/r1", {"Authorization": f"Basic {TOKENS['r1']}"}, 401),
        ("/v1/robots/r1", {"Authorization": f"Bearer {TOKENS['r2']}"}, 403),
        ("/v1/robots/nobody", BEARER, 403),
        ("/v1/robots/r1/next?wait_s=never", BEARER, 400),
        ("/v1/robots/r1/next?wait_s=nan", BEARER, 400),
        ("/v1/robots/r1/next?wait_s=-1", BEARER, 400),
        ("/v1/robots/r1/messages", BEARER, 405),
        ("/v2/robots/r1", BEARER, 404),
    ],
)
def test_requests_are_let_in_by_the_robots_own_token_only(server, path, headers, status):
    assert ask(server, "GET", path, **headers)[0] == status


@pytest.mark.parametrize(
    ("body", "status", "says"),
    [
        (b"{", 400, "not JSON"),
        (b" " * (MAX_BYTES + 1), 413, ""),
        (encode_message(ReportMessage("forged", "r1", 1, Finished(1))), 400, "another session"),
        (encode_message(ReportMessage("forged", "r2", 1, Finished(1))), 400, "not robot r2"),
    ],
)
def test_bad_messages_are_answered_and_change_nothing(server, body, status, says):
    answer = ask(server, "POST", "/v1/robots/r1/messages", body, **BEARER)
    assert answer[0] == status
    assert says in answer[1]
    assert server.robots["r1"].poll() is None


def test_a_body_without_end_is_cut_off(server):
    def chunks():
        for _ in range(3):
            yield b" " * MAX_BYTES

    connection = http.client.HTTPConnection(server.host, server.port, timeout=PATIENCE_S)
    try:
        connection.request("POST", "/v1/robots/r1/messages", chunks(), BEARER, encode_chunked=True)
        status = connection.getresponse().status
    except ConnectionError:
        status = 413  # cut off before the answer could be read
    finally:
        connection.close()
    assert status == 413


def test_an_answer_that_got_lost_is_given_again():
    with RestServer(TOKENS) as server:
        client, robot = connect(server), server.robots["r1"]
        assert robot.send(Order(1, FINISHES[0])) == Accepted(1)
        assert client.pull(30)
        order = client.side.order
        client._address = (server.host, 1)  # the way to the server is gone
        with pytest.raises(OSError, match="refused"):
            client.side.report(Finished(order.number))
        client._address = (server.host, server.port)
        assert client.pull(30)  # the step, once more
        assert client.side.order is None
        assert robot.poll(PATIENCE_S) == Finished(1)


def test_a_robot_nobody_has_heard_of_gets_no_orders():
    with RestServer(TOKENS, silence_s=0.0) as server:
        robot = server.robots["r1"]
        assert robot.send(Order(1, HANGS)) == Refused(1, "not connected")
        connect(server)
        assert isinstance(robot.send(Order(1, HANGS)), Refused)


def test_a_refused_client_says_so(server):
    with pytest.raises(RobotError, match="401"):
        RestClient(server.host, server.port, "r1", "forged").pull(0)


@pytest.mark.parametrize("tokens", [{"r1": "short"}, {"r1": "x" * 16, "r2": "x" * 16}])
def test_tokens_that_protect_nobody_are_refused(tokens):
    with pytest.raises(UsageError, match="token"):
        RestServer(tokens)

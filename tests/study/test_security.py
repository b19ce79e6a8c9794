"""What an attacker would try: nothing of it works, nothing leaks, nothing answers with a server error."""

import io
import json
import secrets
import zipfile

import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from itsdangerous import URLSafeSerializer
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import response_schema_conformance, status_code_conformance
from starlette.responses import PlainTextResponse
from starlette.testclient import TestClient
from studies import Visitor, open_study, write_study

from explicable.first_response import read_map
from explicable.study import schema as tables
from explicable.study.folder import open_database, read_secret
from explicable.study.materials import read_materials
from explicable.study.pages import Pages
from explicable.study.refusals import Refusals
from explicable.study.security import MAX_BODY_BYTES, Guard, Keys, Limiter
from explicable.study.store import DATABASE, Store
from explicable.study.view import Views


@pytest.fixture
def study(tmp_path):
    client, url, opened = open_study(write_study(tmp_path, extra='contact = "<b>me</b>"'))
    with client:
        yield client, url, opened.new_password


@pytest.fixture
def client(study):
    return study[0]


def sign_in(client, password):
    return client.post("/admin/login", data={"password": password}, follow_redirects=False)


def test_every_page_is_strict(client):
    visitor = Visitor(client).reach_tasks()
    for path in ("/", "/session", "/admin/login", "/nowhere", "/static/study.js", "/api/view"):
        response = visitor.client.get(path)
        policy = response.headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert response.headers["x-content-type-options"] == "nosniff"
        assert " style=" not in response.text
        assert "<b>me</b>" not in response.text
        assert "http://" not in response.text.replace("http://www.w3.org/", "").replace("http://study", "")


def test_forged_and_foreign_cookies_open_nothing(study):
    client, url, _ = study
    visitor = Visitor(client).reach_tasks()
    token, own = visitor.token, client.cookies["study"]
    store = Store(url)
    session = store.read(lambda tx: tx.all(tables.SESSIONS)[0].id)
    secret = store.read(read_secret)
    store.close()
    forged = [
        session,
        own[:-9] + ("a" if own[-9] != "a" else "b") + own[-8:],  # of the last one not all bits count
        URLSafeSerializer("guess", salt="session").dumps(session),
        URLSafeSerializer(secret, salt="ticket").dumps(session),
        URLSafeSerializer(secret, salt="session").dumps("nobody's"),
        "é\x00'--",
    ]
    for cookie in forged:
        client.cookies.clear()
        headers = {"cookie": f"study={cookie}".encode(), "x-token": token}
        assert client.get("/api/view", headers=headers).status_code == 401
        body = {"request_id": "a" * 32, "number": 0}
        refused = client.post("/api/step", json=body, headers=headers)
        assert refused.status_code in {401, 403}
        assert "picture" not in refused.text


def test_a_session_obeys_only_its_own_pages(client):
    first = Visitor(client).reach_tasks()
    foreign = first.token
    second = Visitor(client).reach_tasks()
    for token in ("", foreign, "0" * 64, "ü"):
        headers = {"x-token": token.encode()}
        body = {"request_id": secrets.token_hex(16), "number": 0}
        assert client.post("/api/step", json=body, headers=headers).status_code == 403
        form = {**second.hidden(), "token": token, "decision": "leave", "stage": "tasks"}
        assert client.post("/session", data=form).status_code == 403
    assert second.look().status_code == 200
    assert second.heading == "Task 1 of 2"


def test_consent_needs_a_ticket_of_the_study(client):
    for ticket in ("", "e30.x", URLSafeSerializer("guess", salt="ticket").dumps({"request": "a" * 32})):
        assert client.post("/consent", data={"ticket": ticket, "decision": "yes"}).status_code == 403


def test_nobody_passes_for_a_simulated_participant(client, tmp_path):
    Visitor(client).reach_tasks("?simulated=simulated-myopic-1")
    store = Store(f"sqlite:///{tmp_path / DATABASE}")
    assert [row.origin for row in store.read(lambda tx: tx.all(tables.PARTICIPANTS))] == ["person"]
    store.close()


@pytest.mark.parametrize(
    "operator",
    [
        "(command person c-0-2); drop table labels",
        "(command person '; drop table labels; --)",
        "(move r1 c-0-0 c-0-1)",
        "(visit-room r1 c-0-2)",
        "(believe 0)",
        "(command person c-2-1)",
        "((((",
        "\x00" * 20,
        "(" + "a" * 490 + ")",
    ],
)
def test_only_commands_can_be_commanded(client, operator):
    visitor = Visitor(client).reach_tasks()
    response = visitor.send("command", operator=operator)
    assert response.status_code in {409, 422}
    assert visitor.view()["number"] == 0


@pytest.mark.parametrize(
    "path",
    [
        "/static/../study.toml",
        "/static/%2e%2e/%2e%2e/study/store.py",
        "/static/..%2f..%2fstore.py",
        "/static//etc/passwd",
        "/study.db",
        "/static/",
        "/.git/config",
        "/docs",
    ],
)
def test_no_file_outside_the_static_folder_is_served(client, path):
    assert client.get(path).status_code in {404, 405}


def test_large_bodies_and_odd_forms_are_refused(client):
    visitor = Visitor(client).reach_tasks()
    large = b"x" * (MAX_BODY_BYTES + 1)
    assert client.post("/session", content=large).status_code == 413
    parts = iter([large[:1000]] * 100)
    assert client.post("/api/step", content=parts, headers={"x-token": visitor.token}).status_code == 413
    files = {"comment": ("a.txt", b"text")}
    assert client.post("/session", files=files).status_code in {400, 403}
    many = {f"f{number}": "1" for number in range(1500)}
    assert client.post("/session", data=many).status_code in {400, 403}
    headers = {"x-token": visitor.token, "content-type": "application/json"}
    for body in (
        b"",
        b"[]",
        b"{",
        b"null",
        b'{"request_id": 1}',
        b"\xff\xfe",
        b'{"number": 1e999}',
        b"[" * 9000,
    ):
        assert client.post("/api/answer", content=body, headers=headers).status_code in {400, 422}
    nan = json.dumps({"request_id": "a" * 32, "number": 0, "explicable": True, "latency_s": float("nan")})
    assert client.post("/api/answer", content=nan, headers=headers).status_code == 422


def test_a_flood_is_told_to_wait_and_others_are_not(tmp_path):
    now = [0.0]
    session, address = (Limiter(1, burst, clock=lambda: now[0]) for burst in (3, 5))

    materials = read_materials(write_study(tmp_path, extra='language = "de"'))
    refuse = Refusals(Pages(materials, Keys("secret"), Views(materials.language))).answer
    client = TestClient(Guard(PlainTextResponse("done"), session, address, refuse))

    def send(path, cookie):
        return client.post(path, headers={"cookie": f"study={cookie}"}).status_code

    assert [send("/api/step", "one") for _ in range(5)] == [200, 200, 200, 429, 429]
    assert send("/api/step", "two") == 200
    assert [send("/consent", "") for _ in range(6)] == [200] * 5 + [429]
    assert client.get("/").status_code == 200
    page, told = client.post("/consent"), client.post("/api/step", headers={"cookie": "study=one"})
    assert page.headers["retry-after"] == told.headers["retry-after"] == "1"
    assert "<p>Zu viele Anfragen: bitte warten Sie einen Augenblick.</p>" in page.text
    assert told.json()["error"] == "zu viele Anfragen: bitte warten Sie einen Augenblick"
    now[0] = 1.0
    assert [send("/api/step", "one") for _ in range(2)] == [200, 429]


def test_refusals_are_in_the_participants_language_and_researchers_in_english(tmp_path):
    client, _, _ = open_study(write_study(tmp_path, extra='language = "de"'))
    large = b"x" * (MAX_BODY_BYTES + 1)
    with client:
        for path, status, kind in (("/session", 413, "text/html"), ("/api/step", 413, "application/json")):
            refused = client.post(path, content=large)
            assert refused.status_code == status
            assert refused.headers["content-type"].startswith(kind)
            assert "default-src 'none'" in refused.headers["content-security-policy"]
            assert "das ist zu viel auf einmal" in refused.text.lower()
        assert "Diese Seite gibt es nicht" in client.get("/consent").text
        assert "There is no such page" in client.get("/admin/nowhere").text


def test_what_people_write_is_shown_as_text(client, tmp_path):
    visitor = Visitor(client)
    visitor.arrive("?PROLIFIC_PID=<script>alert(1)</script>")
    assert "<script>alert" not in visitor.page.text
    visitor.reach_tasks()
    visitor.play()
    visitor.play()
    page = visitor.submit(comment="</textarea><script>alert(1)</script>").text
    assert "<script>alert" not in page
    visitor.submit(
        **{"rating-robot": "3", "comment": "a\0b \u202e👍"}
    )  # PostgreSQL stores no null characters
    store = Store(f"sqlite:///{tmp_path / DATABASE}")
    (comment,) = store.read(lambda tx: tx.all(tables.ANSWERS, name="comment"))
    store.close()
    assert comment.value == "ab \u202e👍"


def test_no_network_address_is_stored(client, tmp_path):
    visitor = Visitor(client).reach_tasks()
    visitor.play()
    for path in tmp_path.glob("study.db*"):
        assert b"testclient" not in path.read_bytes()  # the address of starlette's test client


def test_the_researchers_pages_need_the_password(study):
    client, url, password = study
    assert client.get("/admin", follow_redirects=False).headers["location"] == "/admin/login"
    assert client.post("/admin/download", follow_redirects=False).status_code == 303
    assert sign_in(client, password + "x").status_code == 403
    response = sign_in(client, password)
    cookie = response.headers["set-cookie"].lower()
    assert "httponly" in cookie
    assert "samesite=strict" in cookie
    page = client.get("/admin")
    assert "Drop-out" in page.text
    assert client.post("/admin/download", data={"token": "0" * 64}).status_code == 403
    open_database(url, "h", renews_password=True)
    assert client.get("/admin", follow_redirects=False).status_code == 303


def test_the_researcher_sees_and_downloads_what_there_is(study):
    client, _, password = study
    Visitor(client).reach_tasks().play()
    sign_in(client, password)
    page = client.get("/admin").text
    assert "tasks" in page
    token = page.split('name="token" value="')[1].split('"')[0]
    response = client.post("/admin/download", data={"token": token})
    with zipfile.ZipFile(io.BytesIO(response.content)) as archive:
        names = archive.namelist()
        steps = archive.read("data/jsonl/labelled-steps.jsonl").splitlines()
    assert "data/traces/traces.jsonl" in names
    assert not any("recruit" in name for name in names)
    assert len(steps) > 5
    assert client.post("/admin/logout", data={"token": token}, follow_redirects=False).status_code == 303


def test_the_editor_saves_maps_in_their_folder_and_overwrites_none(study, tmp_path):
    client, _, password = study
    assert client.post("/admin/maps/save", json={"rows": ["@*"], "name": "new"}).status_code in {
        303,
        405,
        200,
    }
    assert not (tmp_path / "maps").exists()
    sign_in(client, password)
    token = client.get("/admin/maps").text.split('data-token="')[1].split('"')[0]
    headers = {"x-token": token}

    def save(name, rows, **more):
        return client.post("/admin/maps/save", json={"rows": rows, "name": name}, **more).status_code

    assert save("new", ["@*"]) == 403
    for name in ("../new", "a/b", "", "NEW", "a" * 99, "new.map", "..", "-", "ä"):
        assert save(name, ["@*"], headers=headers) == 422
    for rows in ([], ["@"], ["@x*"], ["@*", "."], ["?"], ["@*" * 20], [""], ["@*"] * 21):
        assert save("new", rows, headers=headers) == 422
    assert not (tmp_path / "maps").exists()
    assert save("new", ["@*"], headers=headers) == 200
    assert read_map(tmp_path / "maps" / "new.map").rows == ("@*",)
    assert save("new", ["@.*"], headers=headers) == 409
    seen = client.post("/admin/maps/look", json={"rows": ["@.x*", "...."]}, headers=headers).json()
    assert "hidden" not in seen["human"]
    assert "1 hidden obstacles" in seen["robot"]
    assert "from" in client.get("/admin/maps?from=../../etc/passwd").text


def test_passwords_can_not_be_tried_fast(study):
    client, _, _ = study
    codes = [403]
    while codes[-1] == 403 and len(codes) < 100:  # on a slow machine some more are let through
        codes.append(sign_in(client, "guess").status_code)
    assert codes[-1] == 429
    assert len(codes) > 10  # who mistypes it now and then is let in


def test_the_interface_keeps_to_its_description(tmp_path):
    client, _, _ = open_study(write_study(tmp_path), trusts_floods=True)
    with client:
        visitor = Visitor(client).reach_tasks()
        own = {"cookies": dict(client.cookies), "headers": {"x-token": visitor.token}}
        schema = schemathesis.openapi.from_asgi("/api/openapi.json", client.app)
        operations = [found.ok() for found in schema.get_all_operations()]
        assert [operation.path for operation in operations] == [
            "/api/view",
            "/api/step",
            "/api/answer",
            "/api/command",
        ]
        for operation in operations:
            examine(operation, own)


def examine(operation, own):
    checks = (not_a_server_error, response_schema_conformance, status_code_conformance)

    @settings(max_examples=20, suppress_health_check=list(HealthCheck))
    @given(case=operation.as_strategy())
    def examine_case(case):
        case.validate_response(case.call(**own), checks=checks)

    examine_case()

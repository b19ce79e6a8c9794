import html
import json
import re
import sqlite3

import pytest
from studies import TASKS, Visitor, open_study, write_study

from explicable.cli import run
from explicable.study import schema as tables
from explicable.study.onlooker import shown
from explicable.study.study_file import read_study


@pytest.fixture
def client(tmp_path):
    client, _, _ = open_study(write_study(tmp_path))
    with client:
        yield client


def rows(folder, table):
    from explicable.study.store import Store, sqlite_url

    store = Store(sqlite_url(folder))
    try:
        return store.read(lambda tx: [dict(row._mapping) for row in tx.all(table)])
    finally:
        store.close()


@pytest.mark.parametrize(
    "play",
    [
        'semantics = "exclusive"',
        'semantics = "persistent"\nmode = "autonomous"',
        'semantics = "exclusive"\nmode = "autonomous"\nask = "before"',
        'semantics = "persistent"\nask = "before"',
    ],
)
def test_a_session_from_consent_to_debrief(tmp_path, play):
    client, _, _ = open_study(write_study(tmp_path, play=play))
    with client:
        visitor = Visitor(client).reach_tasks()
        assert visitor.heading == "Task 1 of 2"
        views = visitor.play()
        assert {"question", "moving"} <= {view["phase"] for view in views}
        assert visitor.heading == "Task 2 of 2"
        visitor.play()
        assert visitor.heading == "Your opinion"
        visitor.submit(**{"rating-robot": "7", "comment": "<script>alert(1)</script>"})
        assert "completion code" in visitor.page.text
    steps, labels = rows(tmp_path, tables.STEPS), rows(tmp_path, tables.LABELS)
    robot_steps = [(s["assignment"], s["number"]) for s in steps if s["agent"] == "r1"]
    assert sorted(robot_steps) == sorted((label["assignment"], label["number"]) for label in labels)
    assert {row["origin"] for row in steps + labels} == {"person"}
    answers = {(row["stage"], row["name"]): row["value"] for row in rows(tmp_path, tables.ANSWERS)}
    assert answers["ratings", "robot"] == "7"
    assert answers["ratings", "comment"] == "<script>alert(1)</script>"


def test_nothing_that_is_hidden_reaches_the_page(client):
    visitor = Visitor(client).reach_tasks()
    views = visitor.play()
    page = visitor.page.text
    for secret in ("one.map", "two.map", '"x"', "hidden"):
        assert secret not in str(views) + re.sub(r'type="hidden"| hidden', "", page)
    assert all(view["task"] is None and view["operator"] is None for view in views)


def test_a_request_that_is_sent_again_is_carried_out_once(client):
    visitor = Visitor(client).reach_tasks()
    view = visitor.move(visitor.view()).json()
    first = visitor.send("step", request_id="a" * 32, number=view["number"])
    again = visitor.send("step", request_id="a" * 32, number=view["number"])
    assert first.json() == again.json()
    assert first.json()["number"] == view["number"] + 1


def test_of_two_tabs_the_later_is_told_how_things_stand(client):
    visitor = Visitor(client).reach_tasks()
    view = visitor.move(visitor.view()).json()
    here = visitor.send("step", number=view["number"])
    there = visitor.send("step", number=view["number"])
    assert there.status_code == 409
    assert there.json()["view"] == here.json()


@pytest.mark.parametrize("ask", ["after", "before"])
def test_steps_that_a_page_shows_by_itself_are_written_down_as_those_it_asks_for(tmp_path, ask):
    written = {}
    for way in ("asks", "shows"):
        client, _, _ = open_study(write_study(tmp_path / way, play=f'ask = "{ask}"'))
        with client:
            visitor = Visitor(client).reach_tasks()
            visitor.play(shows=way == "shows")
        columns = "position", "number", "agent", "operator", "explicable"
        written[way] = [
            [{name: row[name] for name in columns if name in row} for row in rows(tmp_path / way, table)]
            for table in (tables.STEPS, tables.LABELS)
        ]
        stepped = [
            row for row in rows(tmp_path / way, tables.EVENTS) if row["kind"] in {"stepped", "announced"}
        ]
        assert way == "asks" or len(stepped) < len(written[way][0])
    assert written["asks"] == written["shows"]


@pytest.mark.parametrize("is_shown", [False, True])
def test_a_command_takes_effect_before_a_step_that_was_not_yet_shown(client, is_shown):
    visitor = Visitor(client).reach_tasks()
    view = visitor.move(visitor.view()).json()
    offer, other = shown(view), next(c["operator"] for c in reversed(view["commands"]) if c["is_possible"])
    told = {"shown": offer["shown"]} if is_shown else {}
    after = visitor.send("command", operator=other, **told).json()
    assert after["number"] == view["number"] + 1 + is_shown
    assert after["phase"] == ("question" if is_shown else "moving")
    if is_shown:  # the step that was seen is still asked about
        answered = visitor.send("answer", number=after["number"], explicable=False).json()
        assert answered["phase"] == "moving"


def test_what_a_page_never_was_to_show_is_refused(client):
    visitor = Visitor(client).reach_tasks()
    view = visitor.move(visitor.view()).json()
    offer = shown(view)
    right = {"number": offer["number"], "explicable": True, "shown": offer["shown"]}
    for wrong in ({"shown": "(move r1 c-9-9 c-9-8)"}, {"number": offer["number"] + 1}, {"shown": None}):
        refused = visitor.send("answer", **right | wrong)
        assert (refused.status_code, refused.json()["view"]) == (409, view)
    assert visitor.send("answer", **right).status_code == 200
    assert visitor.send("answer", **right).status_code == 409


def test_a_server_that_starts_again_goes_on_where_everybody_was(tmp_path):
    folder = write_study(tmp_path)
    client, url, opened = open_study(folder)
    assert opened.new_password
    with client:
        visitor = Visitor(client).reach_tasks()
        view = visitor.move(visitor.view()).json()
        before, cookies = visitor.view(), dict(client.cookies)
    client, _, opened = open_study(folder, url=url)
    assert opened.new_password is None
    with client:
        visitor = Visitor(client)
        client.cookies.update(cookies)
        visitor.look()
        assert visitor.view() == before
        assert visitor.send("step", number=view["number"]).status_code == 200


def test_wrong_answers_lead_back_to_the_instructions_and_then_out(tmp_path):
    client, _, _ = open_study(write_study(tmp_path, extra="max_attempts = 2"))
    with client:
        visitor = Visitor(client)
        visitor.arrive()
        visitor.consent()
        visitor.submit()
        visitor.play()
        assert "Please answer every question" in visitor.submit().text
        assert "read the instructions again" in visitor.submit(**{"question-1": "now"}).text
        visitor.submit()
        assert visitor.heading == "A few questions"
        assert "ended for you" in visitor.submit(**{"question-1": "now"}).text
    freed = [row for row in rows(tmp_path, tables.ASSIGNMENTS) if row["status"] == "freed"]
    assert len(freed) == 2


def test_an_incomplete_form_that_is_sent_once_more_changes_nothing(client, tmp_path):
    visitor = Visitor(client)
    visitor.arrive()
    visitor.consent()
    visitor.submit()
    visitor.play()
    incomplete = visitor.hidden()
    for _ in range(2):
        assert "Please answer every question" in client.post("/session", data=incomplete).text
    assert rows(tmp_path, tables.ANSWERS) == []
    visitor.submit(**{"question-1": "before"})
    assert "Task 1 of 2" in client.post("/session", data=incomplete).text
    assert [row["value"] for row in rows(tmp_path, tables.ANSWERS)] == ["before"]


def test_who_declines_leaves_no_trace(client, tmp_path):
    visitor = Visitor(client)
    visitor.arrive()
    assert "Nothing has been stored" in visitor.consent("no").text
    assert rows(tmp_path, tables.PARTICIPANTS) == rows(tmp_path, tables.EVENTS) == []


def test_places_run_out_and_come_back_when_somebody_leaves(tmp_path):
    client, _, _ = open_study(write_study(tmp_path, tasks=TASKS.replace("people = 2", "people = 1")))
    with client:
        first = Visitor(client).reach_tasks()
        cookies = dict(client.cookies)
        second = Visitor(client)
        second.arrive()
        assert second.consent().status_code == 409
        client.cookies.update(cookies)
        first.look()
        assert "ended for you" in first.submit(decision="leave").text
        assert Visitor(client).reach_tasks().heading == "Task 1 of 2"


def test_who_was_silent_for_too_long_gives_the_place_back(tmp_path, monkeypatch):
    tasks = TASKS.replace("people = 2", "people = 1")
    client, _, _ = open_study(write_study(tmp_path, extra="time_limit_min = 30", tasks=tasks))
    with client:
        Visitor(client).reach_tasks()
        import time

        now = time.time()
        monkeypatch.setattr(time, "time", lambda: now + 1860)
        assert Visitor(client).reach_tasks().heading == "Task 1 of 2"
    assert sorted(row["stage"] for row in rows(tmp_path, tables.SESSIONS)) == ["returned", "tasks"]


def test_who_leaves_from_a_page_of_what_is_done_has_left(client, tmp_path):
    visitor = Visitor(client).reach_tasks()
    task = visitor.look()
    visitor.play()
    for _ in range(2):
        visitor.page = task  # its last picture is still shown, and the button below it
        assert "You have left the study" in visitor.submit(decision="leave").text
    assert {row["stage"] for row in rows(tmp_path, tables.SESSIONS)} == {"returned"}


def test_places_are_free_again_as_soon_as_the_researcher_looks(tmp_path, capsys):
    folder = write_study(tmp_path, extra="time_limit_min = 1e-9")
    client, _, _ = open_study(folder)
    with client:
        Visitor(client).reach_tasks()
    assert run(["study", "status", str(folder), "--json"]) == 0
    people = json.loads(capsys.readouterr().out)["person"]
    assert people["stages"] == {"returned": 1}
    assert not any(task["under_way"] for task in people["tasks"])


def test_a_preview_on_mechanical_turk_shows_consent_and_starts_nothing(tmp_path):
    folder = write_study(tmp_path, extra='[recruitment]\nplatform = "mturk"')
    client, _, _ = open_study(folder)
    with client:
        preview = client.get("/?assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=H1")
        assert preview.status_code == 200
        assert "This is a preview" in preview.text
        assert "ticket" not in preview.text
        assert client.post("/consent", data={"decision": "yes"}).status_code == 403
        visitor = Visitor(client)
        visitor.arrive("?assignmentId=A1&hitId=H1&workerId=W1")
        assert "This is a preview" not in visitor.page.text
        visitor.consent()
    assert len(rows(folder, tables.PARTICIPANTS)) == 1
    assert {row["name"] for row in rows(folder, tables.RECRUITS)} == {"workerId", "assignmentId", "hitId"}


def test_a_frame_of_mechanical_turk_leads_to_a_tab_and_takes_the_code(tmp_path):
    client, _, _ = open_study(write_study(tmp_path, extra='[recruitment]\nplatform = "mturk"'))
    link = "/?assignmentId=A%261&hitId=H1&workerId=W1&turkSubmitTo={}"
    with client:
        framed = {"sec-fetch-dest": "iframe"}
        page = client.get(link.format("https%3A%2F%2Fworkersandbox.mturk.com%2F"), headers=framed)
        assert 'action="https://workersandbox.mturk.com/mturk/externalSubmit"' in page.text
        assert 'name="assignmentId" value="A&amp;1"' in page.text
        policy = page.headers["content-security-policy"]
        for rule in ("frame-ancestors", "form-action"):
            assert f"{rule} https://www.mturk.com https://workersandbox.mturk.com" in policy
        within = html.unescape(re.search(r'href="(/\?[^"]*)" target="_blank"', page.text)[1])
        assert "ticket" in client.get(within).text  # in the tab: not framed
        assert "form-action 'self'" in client.get(within).headers["content-security-policy"]
        for host in ("https://evil.example", "https://www.mturk.com.evil.example", "javascript:alert(1)"):
            assert "<form" not in client.get(link.format(host), headers=framed).text
    plain, _, _ = open_study(write_study(tmp_path / "plain"))
    with plain:
        assert "frame-ancestors 'none'" in plain.get("/", headers=framed).headers["content-security-policy"]


def test_a_study_in_which_the_robot_can_not_lead_is_warned_of(tmp_path):
    play = 'mode = "autonomous"\nsemantics = "{}"'
    waiting = read_study(write_study(tmp_path, play=play.format("exclusive")))
    assert "never moves without a command" in waiting.warnings[0]
    assert read_study(write_study(tmp_path, play=play.format("persistent"))).warnings == []


def test_recruits_are_recognised_and_nothing_is_invented(tmp_path):
    folder = write_study(tmp_path, tasks=TASKS.replace("people = 2", "people = 9"))
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(
        text + '[recruitment]\nplatform = "prolific"\nreturn_url = "https://pay.example/?cc={code}"\n'
    )
    link = "?PROLIFIC_PID=p1&STUDY_ID=s1&SESSION_ID=v1"
    client, _, _ = open_study(folder)
    with client:
        Visitor(client).reach_tasks(link)
        again = Visitor(client)  # another browser, the same visit: goes on
        again.arrive(link)
        assert "Task 1 of 2" in again.consent().text
        other = Visitor(client)  # another visit of the same person
        other.arrive(link.replace("v1", "v2"))
        assert other.consent().status_code == 409
        bare = Visitor(client)
        bare.arrive("?PROLIFIC_PID=%7B%7B%25PROLIFIC_PID%25%7D%7D")
        assert bare.consent().status_code == 200
        client.cookies.clear()
        again.arrive(link)
        again.consent()
        again.play()
        again.play()
        again.submit(**{"rating-robot": "7"})
        code = re.search(r'class="code">(\w+)<', again.page.text)[1]
        assert f'href="https://pay.example/?cc={code}"' in again.page.text
    assert {row["name"]: row["value"] for row in rows(folder, tables.RECRUITS)} == {
        "PROLIFIC_PID": "p1",
        "STUDY_ID": "s1",
        "SESSION_ID": "v1",
    }
    assert len(rows(folder, tables.SESSIONS)) == 2


@pytest.mark.parametrize(
    "path",
    ["/", "/health", "/session", "/api/view", "/api/openapi.json", "/static/study.css", "/admin/login"],
)
def test_head_tells_what_get_would(client, path):
    Visitor(client).reach_tasks()
    whole, bare = client.get(path), client.head(path)
    assert (bare.status_code, bare.headers, bare.content) == (whole.status_code, whole.headers, b"")


def test_head_opens_no_stream_and_does_nothing(client):
    Visitor(client).reach_tasks()
    assert client.head("/api/changes").headers["content-type"].startswith("text/event-stream")
    assert client.head("/admin", follow_redirects=False).headers["location"] == "/admin/login"
    assert client.head("/consent").status_code == 405


def test_a_database_that_does_not_answer_is_said_and_nothing_is_half_done(tmp_path):
    client, _, _ = open_study(write_study(tmp_path))
    with client:
        visitor = Visitor(client).reach_tasks()
        token, view = visitor.token, visitor.view()
        database = tmp_path / "study.db"
        with sqlite3.connect(database) as connection:
            connection.execute("ALTER TABLE events RENAME TO lost")
        order = view["commands"][0]["operator"]
        refused = visitor.send("command", token=token, request_id="b" * 32, operator=order)
        assert refused.status_code == 503
        with sqlite3.connect(database) as connection:
            connection.execute("ALTER TABLE lost RENAME TO events")
        connection.close()
        assert visitor.view()["number"] == view["number"]
        again = visitor.send("command", token=token, request_id="b" * 32, operator=order)
        assert again.json()["number"] == view["number"] + 1


def test_the_migrated_database_is_the_one_the_schema_describes(tmp_path):
    from alembic.autogenerate import compare_metadata
    from alembic.migration import MigrationContext

    from explicable.study.store import migrate, open_engine

    url = f"sqlite:///{tmp_path / 'study.db'}"
    migrate(url)
    engine = open_engine(url)
    with engine.connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), tables.METADATA) == []
    engine.dispose()


def test_who_was_forgotten_can_begin_anew(tmp_path):
    folder = write_study(tmp_path)
    client, _, _ = open_study(folder)
    with client:
        visitor = Visitor(client).reach_tasks()
        visitor.move(visitor.view())
        (participant,) = rows(folder, tables.PARTICIPANTS)
        assert run(["study", "forget", str(folder), participant["id"], "--yes"]) == 0
        assert visitor.send("step", number=1).status_code == 401  # on which the page loads itself again
        visitor.page = client.get("/session")
        assert "ticket" in visitor.page.text
        visitor.consent()
        assert visitor.heading == "Instructions"
    assert [row["erased"] is None for row in rows(folder, tables.PARTICIPANTS)].count(False) == 1


def test_nothing_of_who_was_forgotten_stays_in_the_file(tmp_path):
    folder = write_study(tmp_path)
    client, _, _ = open_study(folder)
    with client:
        visitor = Visitor(client).reach_tasks()
        visitor.play()
        visitor.play()
        visitor.submit(**{"rating-robot": "7", "comment": "an unmistakable remark"})
        (participant,) = rows(folder, tables.PARTICIPANTS)
        assert run(["study", "forget", str(folder), participant["id"], "--yes"]) == 0
        for path in tmp_path.glob("study.db*"):
            assert b"unmistakable" not in path.read_bytes()


@pytest.mark.parametrize(
    ("old", "new"), [('name = "one"', 'name = "1"'), ("[play]", '[[condition]]\nname = "new"\n[play]')]
)
def test_a_study_that_was_changed_under_people_says_so(tmp_path, old, new):
    folder = write_study(tmp_path, tasks=TASKS.partition('[[task]]\nname = "two"')[0])
    client, url, _ = open_study(folder)
    with client:
        Visitor(client).reach_tasks()
        cookies = dict(client.cookies)
    file = folder / "study.toml"
    file.write_text(file.read_text().replace(old, new))
    client, _, _ = open_study(folder, url=url)
    client.cookies.update(cookies)
    with client:
        page, view = client.get("/session"), client.get("/api/view")
        assert page.status_code == view.status_code == 409
        assert "The study has changed" in page.text
        visitor = Visitor(client)
        client.cookies.update(cookies)
        assert run(["study", "status", str(folder)]) == 0
        assert visitor.arrive().status_code == 409


LINKS = {
    "plain": "?who=1",
    "prolific": "?PROLIFIC_PID=p1&STUDY_ID=s1&SESSION_ID=v1",
    "mturk": "?workerId=W1&assignmentId=A1&hitId=H1",
    "sona": "?survey_code=123",
}


@pytest.mark.parametrize("platform", list(LINKS))
def test_whoever_opens_the_platforms_link_again_goes_on(tmp_path, platform):
    folder = write_study(tmp_path, tasks=TASKS.replace("people = 2", "people = 9"))
    text = (folder / "study.toml").read_text()
    fields = "".join(f"&{name}={{{name}}}" for name in re.findall(r"(\w+)=", LINKS[platform]))
    fields = "" if platform == "plain" else fields
    link = f'[recruitment]\nplatform = "{platform}"\nreturn_url = "https://pay.example/?c={{code}}{fields}"\n'
    (folder / "study.toml").write_text(text + link)
    client, _, _ = open_study(folder)
    with client:
        visitor = Visitor(client).reach_tasks(LINKS[platform])
        visitor.arrive(LINKS[platform])
        assert visitor.heading == "Task 1 of 2"
        visitor.play()
        visitor.play()
        visitor.submit(**{"rating-robot": "7"})
        code = re.search(r'class="code">(\w+)<', visitor.page.text)[1]
        told = LINKS[platform].replace("?", "&").replace("&", "&amp;") if fields else ""
        assert f'href="https://pay.example/?c={code}{told}"' in visitor.page.text
        if platform != "plain":
            other = Visitor(client)  # somebody else from there, with this browser
            other.arrive(LINKS[platform].replace("1", "2"))
            assert other.consent().status_code == 200
    recruits = {row["name"] for row in rows(folder, tables.RECRUITS)}
    assert recruits == (set() if platform == "plain" else set(re.findall(r"(\w+)=", LINKS[platform])))

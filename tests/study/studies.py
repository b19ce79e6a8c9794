"""Small studies for tests, and somebody who takes part in them over HTTP."""

import re
import secrets
from pathlib import Path

from starlette.testclient import TestClient

from explicable.study.app import create_app
from explicable.study.folder import open_database
from explicable.study.materials import read_materials
from explicable.study.onlooker import shown
from explicable.study.store import Store, sqlite_url

CORRIDOR = "@.*.\n....\n.x.*\n"

PLAN = """(command person c-0-2)
(move r1 c-0-0 c-1-0)
(move r1 c-1-0 c-1-1)
(move r1 c-1-1 c-1-2)
(move r1 c-1-2 c-0-2)
(visit-room r1 c-0-2)
"""

STUDY = """
title = "A study"
practice = "practice.map"
tasks_each = 2
{extra}
[play]
step_s = 0.0
idle_step_s = 0.0
{play}
[[question]]
text = "What is shown?"
choices = ["before", "now"]
answer = "before"
[[rating]]
name = "robot"
text = "How was the robot?"
{tasks}
"""

TASKS = """
[[task]]
name = "one"
map = "one.map"
people = 2
[[task]]
name = "two"
map = "two.map"
people = 2
"""


def write_study(folder, *, extra="", play="", tasks=TASKS):
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("practice", "@*\n"), ("one", CORRIDOR), ("two", "@x*\n...\n")):
        (folder / f"{name}.map").write_text(text)
    (folder / "study.toml").write_text(STUDY.format(extra=extra, play=play, tasks=tasks))
    return folder


def open_study(folder, **options):
    """Make the database and the application; return what drives it, and its URL."""
    url = options.pop("url", None) or sqlite_url(Path(folder))
    opened = open_database(url, read_materials(folder).hash)
    return TestClient(create_app(Path(folder), url, **options), base_url="http://study"), url, opened


def rows(folder, table):
    """Read a whole table of a study's database."""
    store = Store(sqlite_url(folder))
    try:
        return store.read(lambda tx: tx.all(table))
    finally:
        store.close()


class Visitor:
    """Takes part with a browser's means: links, forms, cookies and the scripts' interface."""

    def __init__(self, client):
        self.client = client
        client.cookies.clear()
        self.page = None

    def arrive(self, query=""):
        self.page = self.client.get(f"/{query}")
        return self.page

    def consent(self, decision="yes"):
        ticket = re.search(r'name="ticket" value="([^"]+)"', self.page.text)[1]
        self.page = self.client.post("/consent", data={"ticket": ticket, "decision": decision})
        return self.page

    def hidden(self):
        return dict(re.findall(r'<input type="hidden" name="(\w+)" value="([^"]*)"', self.page.text))

    def submit(self, **fields):
        self.page = self.client.post("/session", data={**self.hidden(), **fields})
        return self.page

    def look(self):
        self.page = self.client.get("/session")
        return self.page

    @property
    def heading(self):
        return re.search(r"<h1>(.*?)</h1>", self.page.text)[1]

    @property
    def token(self):
        return re.search(r'data-token="(\w+)"', self.page.text)[1]

    def view(self):
        return self.client.get("/api/view").json()

    def send(self, what, request_id=None, token=None, **fields):
        body = {"request_id": request_id or secrets.token_hex(16), **fields}
        return self.client.post(f"/api/{what}", json=body, headers={"X-Token": token or self.token})

    def move(self, view, *, explicable=True):
        """Do the one thing that is due."""
        if view["phase"] == "question":
            return self.send("answer", number=view["number"], explicable=explicable, shown=view["shown"])
        if view["phase"] == "moving":
            return self.send("step", number=view["number"])
        command = next(command for command in view["commands"] if command["is_possible"])
        return self.send("command", operator=command["operator"])

    def play(self, *, shows=True):
        """Play the present task to its end; return the views. Steps are shown as pages do, or asked for."""
        self.look()
        views = [self.view()]
        place = views[0]["stage"], views[0]["position"]
        while (views[-1]["stage"], views[-1]["position"]) == place:
            if shows and views[-1]["next"]:
                views.append(shown(views[-1]))
                continue
            response = self.move(views[-1])
            assert response.status_code == 200, response.text
            views.append(response.json())
            assert len(views) < 500
        self.look()
        return views

    def reach_tasks(self, query=""):
        self.arrive(query)
        self.consent()
        self.submit()
        self.play()
        self.submit(**{"question-1": "before"})
        return self

"""A German study at a real browser: no page has English for eyes or screen readers, and axe is content."""

import re

import pytest
from babel.messages.pofile import read_po
from browser import PATIENCE_MS, by_mouse, examine, follow, play, until
from studies import PLAN, write_study

from explicable.study.security import MAX_BODY_BYTES
from explicable.study.serving import Server
from explicable.study.words import LOCALE

STUDY = """
title = "Eine Studie"
language = "de"
contact = "studie@beispiel.de"
practice = "practice.map"
tasks_each = 2
max_attempts = 2
{extra}
[recruitment]
platform = "mturk"
[play]
step_s = 0.0
idle_step_s = 0.0
{play}
[[question]]
text = "Was ist zu sehen?"
choices = ["vorher", "jetzt"]
answer = "vorher"
[[check]]
text = "Wer das liest, nimmt bitte Rot."
choices = ["Blau", "Rot"]
answer = "Rot"
[[rating]]
name = "hilfe"
text = "Wie war der Roboter?"
low = "schlecht"
high = "gut"
[sentences]
command = "Der Raum {{c}} wird gesucht."
move = "{{agent}} fährt von {{from}} nach {{to}}."
visit-room = "{{agent}} besucht {{c}}."
[facts]
at = "Ort: {{2}}"
commanded = "gesucht: {{1}}"
visited = "besucht: {{1}}"
{tasks}
"""
PLAYED = """
[[task]]
name = "gespielt"
map = "one.map"
people = {people}
"""
WATCHED = """
[[task]]
name = "gesehen"
map = "two.map"
plan = "plan.txt"
picture = "none"
people = {people}
"""
ENGLISH = re.compile(
    r"\b(and|are|be|been|done|for|has|have|is|it|not|of|one|order|please|robot|room|step|study|task|thank|that"
    r"|the|there|this|to|visited|waits|we|what|which|with|yes|you|your)\b",
    re.IGNORECASE,
)
SAID = """() => {
  const said = [document.title, ...Object.values(document.querySelector("main").dataset).slice(2)];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) said.push(texts.currentNode.data);
  for (const name of ["aria-label", "aria-description", "title", "alt", "placeholder"])
    for (const element of document.querySelectorAll(`[${name}]`)) said.push(element.getAttribute(name));
  return said;
}"""


@pytest.fixture(scope="module")
def catalogue():
    with (LOCALE / "de" / "LC_MESSAGES" / "study.po").open("rb") as file:
        return {message.id for message in read_po(file) if message.id and message.id != message.string}


@pytest.fixture
def serve(browser, tmp_path):
    """Serve a German study; yields a function that returns its link and a page of a person's browser."""
    opened = []

    def begin(width, *, people, extra="", play=""):
        folder = write_study(tmp_path / "study")
        tasks = PLAYED.format(people=people) + WATCHED.format(people=people)
        (folder / "study.toml").write_text(STUDY.format(extra=extra, play=play, tasks=tasks))
        (folder / "plan.txt").write_text(PLAN)
        served = Server(folder, port=0).in_background()
        link = served.__enter__()
        context = browser.new_context(
            viewport={"width": width, "height": 740}, locale="de-DE", reduced_motion="reduce"
        )
        context.set_default_timeout(PATIENCE_MS)
        opened.extend([context.close, lambda: served.__exit__(None, None, None)])
        return link, context.new_page()

    yield begin
    for close in opened:
        close()


@pytest.fixture
def read(catalogue):
    """Examines a page and finds a German text in it, and no English."""

    def check(page, text):
        assert page.evaluate("document.documentElement.lang") == "de"
        said = page.evaluate(SAID)
        assert text in " ".join(" ".join(said).split())
        assert [part for part in said if ENGLISH.search(part)] == [], page.url
        assert {part.strip() for part in said} & catalogue == set()
        examine(page)

    return check


def arrive(page, link, person):
    page.context.clear_cookies()
    page.goto(f"{link}?workerId={person}&assignmentId=A-{person}&hitId=H")


def submit_incomplete(page):
    """Send a form that lacks answers, as a browser without the attribute would."""
    page.evaluate("for (const e of document.querySelectorAll('[required]')) e.required = false")
    follow(page, "main button")


def look_at_a_task(page, read):
    """Do a task to its end; look at it at its start, at its first question and at its end."""
    read(page, "Aufgabe")
    page.click("#start" if page.is_visible("#start") else "[data-object=c-0-2]")
    until(page, "view.phase === 'question'")
    read(page, "Tut der Roboter das Richtige?")
    play(page, *by_mouse(page))
    read(page, "Weiter")
    follow(page, "#finished a")


def test_a_german_session_from_its_preview_to_its_end(serve, read):
    link, page = serve(1280, people=5)
    page.goto(f"{link}?assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=H")
    read(page, "Dies ist eine Vorschau")
    arrive(page, link, "W1")
    read(page, "Ich willige ein")
    follow(page, "button[value=yes]")
    read(page, "Wand")
    follow(page, "main button")
    read(page, "Dies ist nur zum Üben")
    page.context.set_offline(True)
    page.click("[data-room].possible")
    page.wait_for_selector("#status:has-text('Verbindung')")
    read(page, "Keine Verbindung")
    page.context.set_offline(False)
    until(page, "view.phase === 'question'")
    read(page, "Tut der Roboter das Richtige?")
    play(page, *by_mouse(page))
    read(page, "Diese Aufgabe ist geschafft")
    follow(page, "#finished a")
    read(page, "Einige Fragen")
    submit_incomplete(page)
    read(page, "Bitte beantworten Sie jede Frage")
    page.check("input[value=jetzt]")
    follow(page, "main button")
    read(page, "Nicht alle Ihre Antworten")
    follow(page, "main button")
    page.check("input[value=vorher]")
    follow(page, "main button")
    for _ in range(2):
        look_at_a_task(page, read)
    read(page, "Wie war der Roboter?")
    submit_incomplete(page)
    read(page, "Bitte beantworten Sie jede Frage")
    page.check("input[value='7']", force=True)
    page.check("input[value=Rot]")
    page.evaluate(f"document.querySelector('textarea').value = 'ü'.repeat({MAX_BODY_BYTES})")
    follow(page, "main button")
    read(page, "Das ist zu viel auf einmal")
    follow(page, "main a")
    page.check("input[value='7']", force=True)
    page.check("input[value=Rot]")
    page.fill("textarea", "Gut! 👍 مرحبا")
    follow(page, "main button")
    read(page, "Vielen Dank")


def test_german_pages_where_a_visit_ends_early(serve, read):
    link, page = serve(
        360, people=1, extra="", play='ask = "before"\nmode = "autonomous"\nsemantics = "persistent"'
    )
    turk = "https://www.mturk.com"
    source = f"{link}?workerId=W1&assignmentId=A1&hitId=H1&turkSubmitTo={turk}"
    shown = f'<iframe title="Aufgabe" width="340" height="700" src="{source}"></iframe>'
    page.route(f"{turk}/**", lambda route: route.fulfill(content_type="text/html", body=shown))
    page.goto(f"{turk}/projects/1")
    page.frame_locator("iframe").get_by_role("heading").wait_for()
    read(page.frames[1], "in einem eigenen Reiter")
    arrive(page, link, "W1")
    follow(page, "button[value=no]")
    read(page, "Vielen Dank")
    arrive(page, link, "W1")
    follow(page, "button[value=yes]")
    read(page, "Vor jedem Schritt")
    follow(page, "main button")
    read(page, "Beginnen")
    play(page, *by_mouse(page))
    follow(page, "#finished a")
    for _ in range(2):
        page.check("input[value=jetzt]")
        follow(page, "main button")
        if page.query_selector("main button"):
            follow(page, "main button")
    read(page, "Die Studie ist für Sie beendet")
    page.goto(f"{link}?workerId=W1&assignmentId=A-9&hitId=H")
    follow(page, "button[value=yes]")
    read(page, "schon teilgenommen")
    arrive(page, link, "W2")
    follow(page, "button[value=yes]")
    arrive(page, link, "W3")
    follow(page, "button[value=yes]")
    read(page, "Alle, die wir brauchen")
    arrive(page, link, "W2")
    follow(page, "button[value=yes]")
    page.click("summary")
    follow(page, "button[value=leave]")
    read(page, "verlassen")
    for path in ("consent", "nirgends"):
        page.goto(f"{link}{path}")
        read(page, "Diese Seite gibt es nicht")

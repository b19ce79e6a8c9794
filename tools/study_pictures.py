"""Photograph every page of the study, at two widths: part of `make pictures`. Needs Debian's Chromium."""

import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from explicable.cli import run
from explicable.study.folder import make_folder
from explicable.study.serving import Server

IMAGES = Path(__file__).parents[1] / "docs" / "images" / "study"
EXAMPLE = Path(__file__).parents[1] / "examples" / "warehouse"
REPLAY = """
[places]
at = "1 in 2"
stored = "1 in 2"
carries = "2 in 1"

[[task]]
name = "monday"
domain = "domain.pddl"
problem = "problem.pddl"
human_domain = "human-domain.pddl"
human_problem = "human-problem.pddl"
plan = "plan.txt"
picture = "places"
"""
WIDTHS = {"wide": (1100, 760), "narrow": (360, 740)}
SCHEMES = {"wide": "light", "narrow": "dark"}
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--no-first-run",
    "--disable-features=LocalNetworkAccessChecks",  # for the frame of Mechanical Turk
]
TURK = "https://www.mturk.com"


def open_page(browser: Browser, width: str, scheme: str) -> Page:
    """Open a page of its own, with no cookies."""
    sizes = {"width": WIDTHS[width][0], "height": WIDTHS[width][1]}
    return browser.new_page(viewport=sizes, color_scheme=scheme, reduced_motion="reduce")  # type: ignore[arg-type]


def photograph(page: Page, name: str) -> None:
    """Save what the page looks like, whole."""
    page.wait_for_load_state()
    page.screenshot(path=IMAGES / f"{name}.png", full_page=True)


def until(page: Page, condition: str) -> None:
    """Wait for a condition of the page's script."""
    while not page.evaluate(f"typeof isFinished !== 'undefined' && ({condition})"):
        page.wait_for_timeout(10)


def play(page: Page, width: str, name: str) -> None:
    """Play the task that is shown, and photograph it once on the way where it has a name."""
    is_due = bool(name)
    while True:
        until(page, "isFinished || (!pending && ['question', 'waiting'].includes(view.phase))")
        if page.evaluate("isFinished"):
            return
        if page.evaluate("view.phase") == "question":
            if is_due and page.evaluate("view.number") >= 4:
                photograph(page, f"{name}-{width}")
                is_due = False
            number = page.evaluate("view.number")
            page.keyboard.press("y")
            until(page, f"isFinished || view.phase !== 'question' || view.number !== {number}")
        else:
            page.click("[data-room].possible")
            until(page, "view.phase !== 'waiting'")


def visit(browser: Browser, link: str, width: str, scheme: str) -> None:
    """Walk through a whole session."""
    page = open_page(browser, width, scheme)
    page.goto(link)
    photograph(page, f"consent-{width}")
    page.click("button[value=yes]")
    photograph(page, f"instructions-{width}")
    page.click("main button")
    play(page, width, "practice")
    page.click("#finished a")
    photograph(page, f"questions-{width}")
    page.get_by_text("the building before it was damaged").click()
    page.get_by_text("to visit all marked rooms in few steps").click()
    page.click("main button")
    play(page, width, "task")
    page.click("#finished a")
    photograph(page, f"ratings-{width}")
    for rating in ("robot", "self", "again"):
        page.check(f"input[name=rating-{rating}][value='7']")
    page.click("main button")
    photograph(page, f"debrief-{width}")
    page.goto(f"{link}nowhere")
    photograph(page, f"error-{width}")
    page.close()


def visit_researcher(browser: Browser, link: str, password: str, width: str, scheme: str) -> None:
    """Walk through the researcher's pages."""
    page = open_page(browser, width, scheme)
    page.goto(f"{link}admin")
    photograph(page, f"login-{width}")
    page.fill("input[type=password]", password)
    page.click("main button")
    page.wait_for_selector("table")
    photograph(page, f"researcher-{width}")
    page.goto(f"{link}admin?origin=simulated")
    photograph(page, f"researcher-simulated-{width}")
    page.goto(f"{link}admin/maps?from=training-02")
    page.wait_for_selector("#robot svg")
    photograph(page, f"editor-{width}")
    page.close()


@contextmanager
def serving(folder: Path) -> Iterator[tuple[str, str]]:
    """Serve a study while the block runs; yields its link and the researcher's password."""
    server = Server(folder, port=0, renews_password=True, trusts_floods=True)
    with server.in_background() as link:
        yield link, server.announcement.new_password or ""


def make_replay(folder: Path) -> None:
    """Write a study in which a plan of the warehouse example is watched, for Mechanical Turk."""
    make_folder(folder)
    names = ("domain", "problem", "human-domain", "human-problem")
    for name in names:
        shutil.copy(EXAMPLE / f"{name}.pddl", folder)
    paths = [str(folder / f"{name}.pddl") for name in names]
    human = ["--human-domain", paths[2], "--human-problem", paths[3]]
    if run(["plan", *paths[:2], *human, "-o", str(folder / "plan.txt")]):
        raise SystemExit("the example can't be planned for")
    file = folder / "study.toml"
    text = file.read_text().partition("[[task]]")[0].replace('platform = "plain"', 'platform = "mturk"')
    file.write_text(text.replace("step_s = 1.0", "step_s = 0.0") + REPLAY)


def visit_replay(browser: Browser, link: str, width: str, scheme: str) -> None:
    """Photograph the preview, a replay, and how a visit ends early."""
    page = open_page(browser, width, scheme)
    page.goto(f"{link}?assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=H")
    photograph(page, f"preview-{width}")
    source = f"{link}?assignmentId=A&hitId=H&workerId=W&turkSubmitTo={TURK}"
    shown = (
        f'<body style="margin: 0"><iframe width="100%" height="600" frameborder="0" src="{source}"></iframe>'
    )
    page.route(f"{TURK}/**", lambda route: route.fulfill(content_type="text/html", body=shown))
    page.goto(f"{TURK}/projects")
    page.frame_locator("iframe").get_by_role("heading").wait_for()
    photograph(page, f"doorway-{width}")
    page.goto(link)
    page.click("button[value=no]")
    photograph(page, f"declined-{width}")
    page.goto(link)
    page.click("button[value=yes]")
    page.click("main button")
    play(page, width, "")
    page.click("#finished a")
    page.get_by_text("the building before it was damaged").click()
    page.get_by_text("to visit all marked rooms in few steps").click()
    page.click("main button")
    until(page, "mustStart()")
    page.click("#start")
    play(page, width, "replay")
    page.click("summary")
    page.click("button[value=leave]")
    photograph(page, f"ended-{width}")
    page.close()


def visit_german(browser: Browser, link: str, width: str, scheme: str) -> None:
    """Photograph the second language."""
    page = open_page(browser, width, scheme)
    page.goto(link)
    page.click("button[value=yes]")
    photograph(page, f"german-instructions-{width}")
    page.click("main button")
    play(page, width, "german-practice")
    page.close()


def visit_ends(browser: Browser, link: str, width: str, scheme: str) -> None:
    """Photograph how a visit ends where somebody misunderstands, comes again, or comes too late."""

    def arrive(person: str, visit: str) -> Page:
        page = open_page(browser, width, scheme)
        page.goto(f"{link}?PROLIFIC_PID={person}-{width}&STUDY_ID=s1&SESSION_ID={visit}")
        page.click("button[value=yes]")
        page.wait_for_load_state()
        return page

    page = arrive("p1", "v1")
    page.click("main button")
    play(page, width, "")
    page.click("#finished a")
    for wrong in ("the building as it is now", "to leave the building"):
        page.get_by_text(wrong).click()
    page.click("main button")
    photograph(page, f"excluded-{width}")
    page.close()
    page = arrive("p1", "v2")
    photograph(page, f"repeated-{width}")
    page.close()
    staying = arrive("p2", "v3")
    page = arrive("p3", "v4")
    photograph(page, f"full-{width}")
    page.close()
    staying.click("summary")
    staying.click("button[value=leave]")
    staying.close()


def change(folder: Path, **values: str) -> None:
    """Give keys of a new study other values."""
    file = folder / "study.toml"
    text = file.read_text()
    for key, value in values.items():
        text = re.sub(rf"^{key} = [^#\n]*", f"{key} = {value} ", text, flags=re.MULTILINE)
    file.write_text(text)


def make_studies(home: Path) -> dict[str, Path]:
    """Write a study as `init` does, one of replays, one with a single place, and one in German."""
    whole, small, german = home / "whole", home / "small", home / "german"
    make_folder(whole)
    change(whole, tasks_each="1", step_s="0.0")
    if run(["study", "simulate", str(whole), "-n", "5", "--family", "mission"]):
        raise SystemExit("simulated participants can't take part")
    make_replay(home / "replay")
    make_folder(small)
    change(small, tasks_each="8", step_s="0.0", people="1", max_attempts="1", platform='"prolific"')
    make_folder(german, language="de")
    change(german, step_s="0.0")
    return {"whole": whole, "replay": home / "replay", "small": small, "german": german}


def main() -> None:
    """Serve some studies and walk through them."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as home:
        studies = make_studies(Path(home))
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
            walks = {"whole": visit, "replay": visit_replay, "small": visit_ends, "german": visit_german}
            for name, walk in walks.items():
                with serving(studies[name]) as (link, password):
                    for width, scheme in SCHEMES.items():
                        walk(browser, link, width, scheme)
                    if name == "whole":  # when there is something to see
                        for width, scheme in SCHEMES.items():
                            visit_researcher(browser, link, password, width, scheme)
            browser.close()


main()

"""Photograph every page of the study, at two widths: part of `make pictures`. Needs Debian's Chromium."""

import shutil
import tempfile
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
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"]


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


def visit(browser: Browser, link: str, password: str, width: str, scheme: str) -> None:
    """Walk through a whole session."""
    sizes = {"width": WIDTHS[width][0], "height": WIDTHS[width][1]}
    page = browser.new_page(viewport=sizes, color_scheme=scheme, reduced_motion="reduce")  # type: ignore[arg-type]
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
    page.goto(f"{link}admin")
    photograph(page, f"login-{width}")
    page.fill("input[type=password]", password)
    page.click("main button")
    page.wait_for_selector("table")
    photograph(page, f"researcher-{width}")
    page.goto(f"{link}admin/maps?from=training-02")
    page.wait_for_selector("#robot svg")
    photograph(page, f"editor-{width}")
    page.close()


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
    sizes = {"width": WIDTHS[width][0], "height": WIDTHS[width][1]}
    page = browser.new_page(viewport=sizes, color_scheme=scheme, reduced_motion="reduce")  # type: ignore[arg-type]
    page.goto(f"{link}?assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=H")
    photograph(page, f"preview-{width}")
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


def main() -> None:
    """Serve a study as `init` writes it, and one of replays, and walk through them."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        make_folder(folder)
        file = folder / "study.toml"
        text = (
            file.read_text()
            .replace("tasks_each = 4", "tasks_each = 1")
            .replace("step_s = 1.0", "step_s = 0.0")
        )
        file.write_text(text)
        server = Server(folder, port=0)
        password = server.announcement.new_password or ""
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        with server.in_background() as link:
            visit(browser, link, password, "wide", "light")
            visit(browser, link, password, "narrow", "dark")
        make_replay(folder / "replay")
        with Server(folder / "replay", port=0).in_background() as link:
            visit_replay(browser, link, "wide", "light")
            visit_replay(browser, link, "narrow", "dark")
        browser.close()


main()

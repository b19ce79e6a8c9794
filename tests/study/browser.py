"""Debian's Chromium, driven by Playwright; installed if it is missing. And what people do at its pages."""

import json
import os
import shutil
import time
from contextlib import contextmanager

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import sync_playwright

from debian import alone, run

PATIENCE_MS = 300_000  # nothing takes that long; it is there so that what hangs ends
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-features=LocalNetworkAccessChecks",  # pages of others may show ours in a frame
]


def find_chromium():
    with alone():
        found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
        if found is None and os.geteuid() == 0 and shutil.which("apt-get"):
            run(["apt-get", "update", "-qq"])
            run(["apt-get", "install", "-y", "-qq", "chromium"])
            found = shutil.which("chromium")
    if found is None:
        raise RuntimeError("the browser tests need Chromium: apt-get install chromium")
    return found


@contextmanager
def chromium():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=FLAGS, timeout=PATIENCE_MS)
        try:
            yield browser
        finally:
            browser.close()


def examine(page):
    """Check a page by axe (WCAG 2.2 and good practice), and that nothing sticks out at its sides."""
    found = Axe().run(page, options={"rules": {"target-size": {"enabled": True}}})
    assert found.violations_count == 0, found.generate_report()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), page.url


def until(page, condition):
    """Wait for a condition; Playwright's own way needs what the pages' security policy forbids."""
    ends_at = time.monotonic() + PATIENCE_MS / 1000
    while not page.evaluate(f"typeof isFinished !== 'undefined' && ({condition})"):
        assert time.monotonic() < ends_at, f"{page.url}: {condition}; {page.evaluate('JSON.stringify(view)')}"
        page.wait_for_timeout(10)


def follow(page, selector):
    """Click on what leads to another page, and wait until that is there."""
    with page.expect_navigation():
        page.click(selector)


def press_and_follow(page, key):
    """The same by keyboard."""
    with page.expect_navigation():
        page.keyboard.press(key)


def view_of(page):
    return json.loads(page.evaluate("JSON.stringify(view)"))


def wait_for_turn(page):
    """Wait until the person is asked, may command, has to start, or the task is over."""
    until(page, "isFinished || (!pending && (['question', 'waiting'].includes(view.phase) || mustStart()))")


def play(page, answer, command):
    """Play the task that is shown."""
    while True:
        wait_for_turn(page)
        if page.evaluate("isFinished"):
            return
        if page.evaluate("mustStart()"):
            command("start")
        elif view_of(page)["phase"] == "question":
            number = view_of(page)["number"]
            answer()
            until(page, f"isFinished || view.phase !== 'question' || view.number !== {number}")
        else:
            command("room")
            until(page, "isFinished || view.phase !== 'waiting'")


def by_mouse(page):
    def command(what):
        if what == "start":
            page.click("#start")
        else:
            page.click("[data-room].possible")

    return lambda: page.click("#yes"), command


def by_keyboard(page):
    def command(what):
        if what == "start":
            page.focus("#start")
            page.keyboard.press("Enter")
        else:
            possible = [number for number, c in enumerate(view_of(page)["commands"], 1) if c["is_possible"]]
            page.keyboard.press(str(possible[0]))

    return lambda: page.keyboard.press("n"), command


def begin(page, link):
    page.goto(link)
    follow(page, "button[value=yes]")
    follow(page, "main button")

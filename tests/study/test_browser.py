"""People at a real browser: by mouse, by keyboard alone, with reloads; and axe on every page."""

import time

import pytest
from browser import (
    PATIENCE_MS,
    begin,
    by_keyboard,
    by_mouse,
    examine,
    follow,
    play,
    press_and_follow,
    until,
    view_of,
)
from servers import StudyServer
from studies import PLAN, rows, write_study

from explicable.first_response import read_map
from explicable.study import schema as tables
from explicable.study.serving import Server

REPLAY = """
[[task]]
name = "watched"
map = "two.map"
plan = "plan.txt"
source = "ff"
people = 5
"""
PLAYED = """
[[task]]
name = "played"
map = "one.map"
people = 5
"""


@pytest.fixture
def served(tmp_path):
    folder = write_study(tmp_path / "study", tasks=PLAYED + REPLAY, extra='language = "en"')
    (folder / "plan.txt").write_text(PLAN)
    server = Server(folder, port=0)
    with server.in_background() as link:
        yield folder, link, server.announcement.new_password


@pytest.fixture
def page(browser, served):  # noqa: ARG001 (the browser leaves before the server does)
    context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    problems = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("console", lambda message: problems.append(message.text) if message.type == "error" else None)
    yield page
    context.close()
    assert [problem for problem in problems if "409" not in problem] == []


def test_a_session_by_mouse_with_a_change_of_mind_and_reloads(page, served):
    folder, link, _ = served
    begin(page, link)
    play(page, *by_mouse(page))
    follow(page, "#finished a")
    page.check("input[value=before]")
    follow(page, "main button")
    for _ in range(2):
        if view_of(page)["commands"]:
            page.click("[data-object=c-0-2]")
            until(page, "view.phase === 'question'")
            page.click("[data-room=c-2-3]")  # another room, while the robot is on its way
            until(page, "view.commands.some(c => c.object === 'c-2-3' && c.is_present)")
            page.reload()
            assert next(c for c in view_of(page)["commands"] if c["is_present"])["object"] == "c-2-3"
        play(page, *by_mouse(page))
        follow(page, "#finished a")
    page.check("input[value='7']", force=True)
    page.fill("textarea", "Well done!")
    follow(page, "main button")
    assert page.inner_text(".code")
    labels, steps = rows(folder, tables.LABELS), rows(folder, tables.STEPS)
    assert len(labels) == sum(step.agent == "r1" for step in steps)
    assert all(label.explicable and label.latency_s is not None for label in labels)
    assert {row.stage for row in rows(folder, tables.SESSIONS)} == {"debrief"}


def test_a_command_comes_before_a_step_that_is_not_yet_shown(page, served):
    folder, link, _ = served
    page.clock.install()
    begin(page, link)
    play(page, *by_mouse(page))
    follow(page, "#finished a")
    page.check("input[value=before]")
    follow(page, "main button")
    if not view_of(page)["commands"]:
        play(page, *by_mouse(page))
        follow(page, "#finished a")
    page.clock.pause_at(time.time() + 3600)  # no step is due from now on
    for number, room in enumerate(["c-0-2", "c-2-3"], start=1):
        page.click(f"[data-object={room}]")
        until(page, f"!pending && view.number === {number} && view.phase === 'moving' && view.next")
    offered = view_of(page)["next"]["shown"]
    page.clock.run_for(100)
    until(page, "view.phase === 'question'")
    (task,) = (row.id for row in rows(folder, tables.ASSIGNMENTS) if row.task == "played")

    def operators():
        return [row.operator for row in rows(folder, tables.STEPS) if row.assignment == task]

    assert operators() == ["(command person c-0-2)", "(command person c-2-3)"]
    page.click("#yes")
    until(page, "!pending")
    assert operators()[2:] == [offered]


def test_a_session_by_keyboard_alone(page, served):
    folder, link, _ = served
    page.goto(link)

    def press_button(selector):
        for _ in range(60):
            page.keyboard.press("Tab")
            if page.evaluate(f"document.activeElement.matches('{selector}')"):
                press_and_follow(page, "Enter")
                return
        raise AssertionError(f"{selector} can't be reached with Tab")

    press_button("button[value=yes]")
    press_button("main button")
    page.wait_for_selector("#question")
    play(page, *by_keyboard(page))
    press_and_follow(page, "Enter")  # "Continue" has the focus
    page.keyboard.press("Tab")
    while not page.evaluate("document.activeElement.matches('input[type=radio]')"):
        page.keyboard.press("Tab")
    page.keyboard.press("Space")
    press_button("main button")
    for _ in range(2):
        page.wait_for_selector("#question")
        play(page, *by_keyboard(page))
        press_and_follow(page, "Enter")
    page.wait_for_selector("textarea")
    while not page.evaluate("document.activeElement.matches('input[type=radio]')"):
        page.keyboard.press("Tab")
    page.keyboard.press("Space")
    press_button("main button")
    page.wait_for_selector(".code")
    labels = rows(folder, tables.LABELS)
    assert labels
    assert not any(label.explicable for label in labels)


def test_two_tabs_show_the_same_task_and_take_each_step_once(page, served):
    folder, link, _ = served
    begin(page, link)
    other = page.context.new_page()
    other.goto(f"{link}session")
    page.click("[data-room].possible")
    until(other, "view.phase === 'question'")
    other.click("#no")
    until(page, "view.number >= 3 || isFinished")
    play(page, *by_mouse(page))
    until(other, "isFinished")
    numbers = [(step.assignment, step.number) for step in rows(folder, tables.STEPS)]
    assert len(numbers) == len(set(numbers))
    assert rows(folder, tables.LABELS)[0].explicable is False


def test_a_map_is_painted_by_mouse_and_keys_and_saved(page, served):
    folder, link, password = served
    page.goto(f"{link}admin")
    page.fill("input[type=password]", password)
    follow(page, "main button")
    follow(page, "text=Map editor")
    page.wait_for_selector("#grid button")

    def paint(character, row, column):
        page.check(f"#palette input[value='{character}']")
        page.locator("#grid tr").nth(row).locator("button").nth(column).click()

    def status(text):
        page.wait_for_selector(f"#status:has-text('{text}')")

    status("no robot")
    paint("@", 1, 1)
    status("no marked room")
    paint("*", 1, 3)
    status("Every marked room can be reached")
    page.locator("#grid tr").nth(1).locator("button").nth(1).focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("x")
    page.keyboard.press("ArrowDown")
    for _ in range(6):
        page.keyboard.press("x")
        page.keyboard.press("ArrowLeft")
    status("cannot be reached")
    assert page.get_attribute("#save-button", "aria-disabled") == "true"
    page.locator("#grid tr").nth(1).locator("button").nth(2).focus()
    page.keyboard.press(".")
    status("Every marked room can be reached")
    examine(page)
    page.fill("#name", "painted")
    page.click("#save-button")
    status("Saved as maps/painted.map")
    world = read_map(folder / "maps" / "painted.map")
    assert world.marks == ((1, 3),)
    assert (1, 2) not in world.hidden
    assert world.hidden


@pytest.mark.parametrize(("scheme", "width"), [("light", 1280), ("dark", 360)])
def test_axe_finds_no_violation_on_any_page(browser, served, scheme, width):
    _, link, password = served
    context = browser.new_context(
        viewport={"width": width, "height": 740}, color_scheme=scheme, reduced_motion="reduce"
    )
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(link)
    examine(page)
    follow(page, "button[value=yes]")
    examine(page)
    follow(page, "main button")
    examine(page)
    page.click("[data-object]")
    until(page, "view.phase === 'question'")
    examine(page)
    play(page, *by_mouse(page))
    examine(page)
    follow(page, "#finished a")
    examine(page)
    page.check("input[value=before]")
    follow(page, "main button")
    for _ in range(2):
        examine(page)
        play(page, *by_mouse(page))
        follow(page, "#finished a")
    examine(page)
    page.check("input[value='7']", force=True)
    follow(page, "main button")
    examine(page)
    for path in ("admin", "nowhere", "session/nowhere", "admin/maps"):
        page.goto(f"{link}{path}")
        examine(page)
    page.goto(f"{link}admin")
    for tried in ("wrong", password):
        page.fill("input[type=password]", tried)
        follow(page, "main button")
        examine(page)
    for path in ("admin", "admin?origin=simulated", "admin/maps"):
        page.goto(f"{link}{path}")
        page.wait_for_selector("table")
        examine(page)
    context.close()


def test_axe_finds_no_violation_where_a_visit_ends_early(browser, tmp_path):
    extra = 'max_attempts = 1\n[recruitment]\nplatform = "mturk"'
    folder = write_study(tmp_path / "study", tasks=REPLAY.replace("people = 5", "people = 1"), extra=extra)
    (folder / "plan.txt").write_text(PLAN)
    server = Server(folder, port=0)
    with server.in_background() as link:
        context = browser.new_context(
            viewport={"width": 360, "height": 740}, color_scheme="dark", reduced_motion="reduce"
        )
        context.set_default_timeout(PATIENCE_MS)
        page = context.new_page()

        def arrive(person):
            context.clear_cookies()
            page.goto(f"{link}?workerId={person}&assignmentId=A-{person}&hitId=H")

        def examine_that(text):
            assert text in page.inner_text("main")
            examine(page)

        page.goto(f"{link}?assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=H")
        examine_that("This is a preview")
        assert page.locator("button").count() == 0
        arrive("W1")
        follow(page, "button[value=no]")
        examine_that("Nothing has been stored")
        arrive("W1")
        follow(page, "button[value=yes]")
        page.click("summary")
        follow(page, "button[value=leave]")
        examine_that("You have left the study")
        arrive("W2")
        follow(page, "button[value=yes]")
        follow(page, "main button")
        play(page, *by_mouse(page))
        follow(page, "#finished a")
        page.check("input[value=now]")
        follow(page, "main button")
        examine_that("not right often enough")
        page.goto(f"{link}?workerId=W2&assignmentId=A-9&hitId=H")
        follow(page, "button[value=yes]")
        examine_that("You have taken part in this study before")
        arrive("W3")
        follow(page, "button[value=yes]")
        arrive("W4")
        follow(page, "button[value=yes]")
        examine_that("Everybody whom we need has taken part")
        context.close()


def test_a_frame_of_mechanical_turk_opens_a_tab_and_hands_in_the_code(browser, tmp_path):
    folder = write_study(tmp_path / "study", tasks=PLAYED, extra='[recruitment]\nplatform = "mturk"')
    turk = "https://www.mturk.com"
    with Server(folder, port=0).in_background() as link:
        context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
        context.set_default_timeout(PATIENCE_MS)
        page = context.new_page()
        source = f"{link}?workerId=W1&assignmentId=A1&hitId=H1&turkSubmitTo={turk}"
        shown = f'<iframe title="task" width="360" height="700" src="{source}"></iframe>'
        page.route(f"{turk}/**", lambda route: route.fulfill(content_type="text/html", body=shown))
        page.goto(f"{turk}/projects/1")
        frame = page.frame_locator("iframe")
        frame.get_by_role("heading").wait_for()
        examine(page.frames[1])
        with context.expect_page() as opened:
            frame.get_by_role("link", name="To the study").click()
        tab = opened.value
        follow(tab, "button[value=yes]")
        assert "Instructions" in tab.inner_text("main")
        frame.get_by_role("textbox").fill("K7")
        with page.expect_request(f"{turk}/mturk/externalSubmit") as handed_in:
            frame.get_by_role("button").click()
        assert handed_in.value.post_data == "assignmentId=A1&code=K7"
        context.close()


def test_a_page_goes_on_by_itself_when_its_server_was_killed(browser, tmp_path):
    folder = write_study(tmp_path / "study", tasks=PLAYED)
    with StudyServer(folder) as server:
        context = browser.new_context(has_touch=True, viewport={"width": 360, "height": 740})
        context.set_default_timeout(PATIENCE_MS)
        page = context.new_page()
        begin(page, server.link)
        page.tap("[data-room].possible")
        until(page, "view.phase === 'question'")
        number = view_of(page)["number"]
        server.kill()
        page.tap("#yes")
        until(page, f"isFinished || view.number > {number}")
        play(page, lambda: page.tap("#yes"), lambda _: page.tap("[data-room].possible"))
        page.wait_for_selector("#finished a")
        context.close()
    labels = rows(folder, tables.LABELS)
    assert len(labels) == len({(label.assignment, label.number) for label in labels}) > 0


def test_clicking_twice_is_clicking_once(page, served):
    folder, link, _ = served
    page.goto(link)
    page.dblclick("button[value=yes]")
    page.wait_for_selector("h1:has-text('Instructions')")
    follow(page, "main button")
    page.dblclick("[data-room].possible")
    until(page, "!pending && view.phase === 'question'")
    page.dblclick("#yes")
    page.dblclick("#yes")
    play(page, *by_mouse(page))
    assert len(rows(folder, tables.SESSIONS)) == 1
    steps = sorted((step.number, step.operator) for step in rows(folder, tables.STEPS))
    assert [operator for _, operator in steps if operator.startswith("(command")] == [steps[0][1]]
    labels = rows(folder, tables.LABELS)
    assert len(labels) == len(steps) - 1


def test_a_request_whose_answer_is_lost_is_sent_again_and_carried_out_once(page, served):
    folder, link, _ = served
    page.add_init_script(
        "const after = AbortSignal.timeout.bind(AbortSignal); let number = 0;"
        "AbortSignal.timeout = (ms) => after(number++ ? ms : 100);"  # the first is given up soon
    )
    held = []

    def hold_the_first(route):
        held.append(route.fetch().status)  # it is carried out
        if len(held) > 1:
            route.fallback()

    page.route("**/api/command", hold_the_first)
    begin(page, link)
    page.click("[data-room].possible")
    until(page, "!pending && view.phase === 'question'")
    assert held[0] == 200
    assert len(held) > 1
    assert [row.kind for row in rows(folder, tables.EVENTS)].count("commanded") == 1
    play(page, *by_mouse(page))

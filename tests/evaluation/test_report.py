"""The page of results: complete, self-contained, and proof against hostile words and broken pictures."""

import re
from html.parser import HTMLParser

import pytest

from explicable.errors import UsageError
from explicable.evaluation.report import PlanPanel, Ratio, Report, Scenario, render_report, write_report
from explicable.first_response import key_entries, render
from explicable.first_response.world import World

HOSTILE = "<script>alert('&')</script>"
PICTURE = render(World(("@x*", "...")), "robot", title=HOSTILE)

STEPS = (("(move r1 c-0-0 c-0-1)", False), (HOSTILE, None), ("(visit-room r1 c-0-1)", True))


def report(**changes):
    panels = tuple(
        PlanPanel(kind, HOSTILE, PICTURE, 31, 0.7096, None, 0.5, STEPS)
        for kind in ("ff", "explicable", "other")
    )
    values = {
        "title": HOSTILE,
        "summary": HOSTILE,
        "settings": {HOSTILE: HOSTILE, "seed": "7"},
        "ratios": (
            Ratio("ff", "FF plan", 124, 0.7, 0.6, None),
            Ratio("other", HOSTILE, 100, None, None, 1.0),
        ),
        "scenarios": tuple(Scenario(f"test-{number}", panels) for number in range(5)),
        "key": key_entries(),
        "notes": (HOSTILE,),
    }
    return Report(**values | changes)


class Reader(HTMLParser):
    """Collects tags and whatever could ask for something from elsewhere."""

    def __init__(self):
        super().__init__()
        self.tags, self.references = [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.references += [value for name, value in attrs if name in {"src", "href", "xlink:href", "data"}]


def test_the_page_shows_every_plan_and_needs_nothing_from_elsewhere():
    page = render_report(report())
    reader = Reader()
    reader.feed(page)
    assert reader.tags.count("figure") == 15
    assert reader.tags.count("li") == 15 * len(STEPS) + len(key_entries())
    assert page.count("<em>inexplicable</em>") == 15
    assert not reader.references
    assert not {"script", "link", "iframe", "img"} & set(reader.tags)
    addresses = set(re.findall(r"https?://[^\s\"'<]+", page))
    assert addresses == {"http://www.w3.org/2000/svg"}  # a name, not an address that is fetched
    for figure in ("0.710", "0.672", "0.757", "–"):
        assert figure in page


def test_an_empty_report_is_a_page_too():
    assert "</html>" in render_report(Report("Nothing yet", "", {}, (), ()))


@pytest.mark.parametrize("picture", ["<p>no picture</p>", "<svg", "</figure>"])
def test_what_is_no_picture_is_refused(picture):
    with pytest.raises(UsageError, match="picture"):
        render_report(report(key=((picture, "sign"),)))


def test_every_map_has_plans_of_the_same_kinds():
    scenarios = report().scenarios
    with pytest.raises(UsageError, match="'lone'"):
        render_report(report(scenarios=(*scenarios, Scenario("lone", scenarios[0].panels[:1]))))


def test_the_page_is_written_as_it_is_rendered(tmp_path):
    write_report(tmp_path / "new" / "report.html", report())
    assert (tmp_path / "new" / "report.html").read_text("utf-8") == render_report(report())

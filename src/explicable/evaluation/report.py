"""The demo's results as one page of HTML that needs nothing besides itself."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

from explicable.errors import UsageError
from explicable.model.files import write_whole

if TYPE_CHECKING:
    from jinja2 import Environment

PAPER_RATIOS: Mapping[str, float] = {"ff": 0.672, "explicable": 0.820, "participants": 0.811}
"""Table 1 of the paper: explicability ratio over all test problems, by plan type."""
PAPER_SCENARIOS: tuple[Mapping[str, float], ...] = (
    {"ff": 1.0, "explicable": 1.0},
    {"ff": 0.56, "explicable": 0.714},
    {"ff": 0.629, "explicable": 0.757},
    {"ff": 0.8, "explicable": 0.8},
)
"""Table 2 of the paper: explicability score by test problem."""


@dataclass(frozen=True, slots=True)
class PlanPanel:
    """One plan for one map: a picture and what there is to say of it in numbers.

    Parameters
    ----------
    kind
        ``ff``, ``explicable`` or ``participants``, as in the paper's tables; others have no figure there.
    title
        Heading, such as "FF plan".
    svg
        An SVG element, put into the page as it is.
    num_steps
        Length of the plan.
    f_paper, f_robot, f_expected
        Explicability (method page, section 2); None where it does not apply.
    steps
        The plan in words: each step, and whether it is explicable.
    """

    kind: str
    title: str
    svg: str
    num_steps: int
    f_paper: float | None
    f_robot: float | None
    f_expected: float | None
    steps: tuple[tuple[str, bool | None], ...] = ()


@dataclass(frozen=True, slots=True)
class Scenario:
    """A test map with its plans, in the order in which they stand side by side."""

    name: str
    panels: tuple[PlanPanel, ...]


@dataclass(frozen=True, slots=True)
class Ratio:
    """One plan type over all test maps: ratios of sums, not means of ratios."""

    kind: str
    title: str
    num_steps: int
    f_paper: float | None
    f_robot: float | None
    f_expected: float | None


@dataclass(frozen=True, slots=True)
class Report:
    """What the page says.

    Parameters
    ----------
    title, summary
        Heading, and a sentence or two below it.
    settings
        What the figures depend on, by name; the seed among them.
    ratios
        The rows of the paper's Table 1.
    scenarios
        The test maps: the rows of its Table 2, and the pictures.
    key
        The signs in the pictures, SVG elements, and what they mean.
    notes
        What a reader must know to judge the figures, one paragraph each.
    """

    title: str
    summary: str
    settings: Mapping[str, str]
    ratios: tuple[Ratio, ...]
    scenarios: tuple[Scenario, ...]
    key: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()


def render_report(report: Report) -> str:
    """Return the page. It holds no scripts and asks for nothing from elsewhere.

    Raises
    ------
    UsageError
        A picture is not an SVG element, or a map lacks a plan that the first one has.

    Examples
    --------
    >>> page = render_report(Report("A < B", "Shown.", {"seed": "7"}, (), ()))
    >>> page.splitlines()[0], "A &lt; B" in page
    ('<!doctype html>', True)
    """
    pictures = [panel.svg for scenario in report.scenarios for panel in scenario.panels]
    for svg in [*pictures, *(sign for sign, _ in report.key)]:
        check_picture(svg)
    first = report.scenarios[0].panels if report.scenarios else ()
    kinds = [panel.kind for panel in first]
    for scenario in report.scenarios:
        if [panel.kind for panel in scenario.panels] != kinds:
            raise UsageError(f"the plans of {scenario.name!r} are not of the kinds {', '.join(kinds)}")
    return (
        make_environment()
        .get_template("report.html.jinja")
        .render(
            report=report,
            plan_titles=[panel.title for panel in first],
            paper_ratios=PAPER_RATIOS,
            paper_scenarios=PAPER_SCENARIOS,
        )
    )


def write_report(path: str | Path, report: Report) -> None:
    """Write the page to a file, whole or not at all."""
    write_whole(path, render_report(report))


def make_environment() -> "Environment":
    """Make what the pages' templates are read and filled in with; the pages share one style sheet."""
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("explicable.evaluation", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(score=_score, drawing=Markup)
    return environment


def _score(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"


def check_picture(svg: str) -> None:
    """Refuse what is not one well-formed SVG element.

    Raises
    ------
    UsageError
        Says what it is instead.
    """
    try:
        root = ET.fromstring(svg)  # noqa: S314  (our own drawings, checked so that none can break the page)
    except ET.ParseError as error:
        raise UsageError(f"a picture is not well-formed: {error}") from error
    if root.tag != "{http://www.w3.org/2000/svg}svg":
        raise UsageError(f"a picture is not an SVG element but {root.tag!r}")

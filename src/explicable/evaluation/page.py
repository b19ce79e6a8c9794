"""Results as a reader sees them: questions, answers, tables and figures, as HTML, Markdown and LaTeX."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from explicable.evaluation.report import check_picture, make_environment
from explicable.evaluation.statistics import Estimate
from explicable.model.files import write_whole


@dataclass(frozen=True, slots=True)
class Table:
    """A table of words and figures that are already written out.

    Parameters
    ----------
    name
        Of its LaTeX file.
    title
        What it shows.
    columns
        Headings.
    rows
        A cell for each column; the first is the row's heading.
    note
        What one must know to read it.
    """

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


@dataclass(frozen=True)  # no slots: the drawing is kept
class Picture:
    """A figure, and what it shows; it is drawn when it is first asked for, as Markdown has none."""

    name: str
    title: str
    draw: Callable[[], str]

    @cached_property
    def svg(self) -> str:
        """The SVG element."""
        return self.draw()


@dataclass(frozen=True, slots=True)
class Section:
    """One question: its answers in a sentence each, computed from the figures, and what they rest on.

    The headline stands for the section at the top of the page: the first answer, unless another is given.
    """

    name: str
    question: str
    answers: tuple[str, ...]
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()
    headline: str = ""

    @property
    def in_short(self) -> str:
        """The headline.

        Examples
        --------
        >>> Section("cost", "What does it cost?", ("Little.", "On maps, nothing.")).in_short
        'Little.'
        """
        return self.headline or next(iter(self.answers), "")


@dataclass(frozen=True, slots=True)
class Page:
    """The whole of the results.

    Parameters
    ----------
    title, summary
        Heading, and a sentence or two below it.
    facts
        Date, machine, versions, seeds and the like, by name.
    sections
        One a question.
    failures
        What went wrong and nobody has explained; there even when it is empty.
    """

    title: str
    summary: str
    facts: Mapping[str, str]
    sections: tuple[Section, ...]
    failures: Table


def format_estimate(found: Estimate | None, digits: int = 3, unit: str = "") -> str:
    """Write a figure with its interval and n.

    Examples
    --------
    >>> format_estimate(Estimate(0.8214, 0.8, 0.843, 100, 20))
    '0.821 [0.800, 0.843] (n = 100)'
    """
    if found is None:
        return "–"
    value, low, high = (f"{number:.{digits}f}{unit}" for number in (found.value, found.low, found.high))
    return f"{value} [{low}, {high}] (n = {found.num})"


def render_html(page: Page) -> str:
    """Return one page of HTML that needs nothing besides itself.

    Examples
    --------
    >>> nothing = Table("failures", "Unexplained failures", ("run",), ())
    >>> render_html(Page("A < B", "", {}, (), nothing)).splitlines()[0]
    '<!doctype html>'
    """
    for section in page.sections:
        for picture in section.pictures:
            check_picture(picture.svg)
    return make_environment().get_template("results.html.jinja").render(page=page)


def render_markdown(page: Page) -> str:
    """Return the same as Markdown, without the figures; the headlines come first.

    Examples
    --------
    >>> nothing = Table("failures", "Unexplained failures", ("run",), ())
    >>> print(render_markdown(Page("Results", "All of them.", {"seed": "1"}, (), nothing)).splitlines()[4])
    - seed: 1
    """
    lines = [f"# {page.title}", "", page.summary, ""]
    lines += [f"- {name}: {value}" for name, value in page.facts.items()]
    in_short = [
        f"- **{section.question}** {section.in_short}" for section in page.sections if section.answers
    ]
    lines += ["", *in_short] if in_short else []
    for section in page.sections:
        lines += ["", f"## {section.question}", "", *(f"- {answer}" for answer in section.answers)]
        for table in section.tables:
            lines += ["", *_markdown_table(table)]
    lines += ["", f"## {page.failures.title}", "", *_markdown_table(page.failures)[2:]]
    return "\n".join(lines) + "\n"


def render_latex(table: Table) -> str:
    r"""Return a table for a paper; it needs the package booktabs.

    Examples
    --------
    >>> print(render_latex(Table("t", "Cost & time", ("plan", "F"), (("FF", "0.8"),))).splitlines()[2])
    \begin{tabular}{lr}
    """
    rows = [" & ".join(map(_latex, row)) + r" \\" for row in table.rows]
    return "\n".join(
        [
            r"\begin{table}",
            rf"\caption{{{_latex(table.title)}}}",
            rf"\begin{{tabular}}{{l{'r' * (len(table.columns) - 1)}}}",
            r"\toprule",
            " & ".join(map(_latex, table.columns)) + r" \\",
            r"\midrule",
            *rows,
            r"\bottomrule",
            r"\end{tabular}",
            r"\end{table}",
            "",
        ]
    )


def write_page(page: Page, folder: Path) -> None:
    """Write ``report.html``, ``results.md``, ``tables/*.tex`` and ``figures/*.svg``."""
    for section in page.sections:
        for table in section.tables:
            write_whole(folder / "tables" / f"{section.name}-{table.name}.tex", render_latex(table))
        for picture in section.pictures:
            write_whole(folder / "figures" / f"{section.name}-{picture.name}.svg", picture.svg)
    write_whole(folder / "results.md", render_markdown(page))
    write_whole(folder / "report.html", render_html(page))


def _markdown_table(table: Table) -> list[str]:
    def row(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.replace("|", r"\|").replace("\n", " ") for cell in cells) + " |"

    lines = [f"**{table.title}**", ""]
    if not table.rows:
        return [*lines, "None."]
    lines += [row(table.columns), row(["---"] * len(table.columns)), *map(row, table.rows)]
    return [*lines, "", table.note] if table.note else lines


def _latex(text: str) -> str:
    escaped = re.sub(r"([&%$#_{}])", r"\\\1", text.replace("\\", r"\textbackslash "))
    return escaped.replace("–", "--").replace("−", "$-$").replace("≥", r"$\geq$").replace("≤", r"$\leq$")

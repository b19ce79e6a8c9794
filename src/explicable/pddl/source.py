"""PDDL text as a stream of tokens that know their place, and the check of its brackets."""

import re
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from explicable.errors import PDDLError

MAX_NESTING = 200  # far beyond any task; keeps every recursion over formulas away from Python's limit

_COMMENT = re.compile(r";[^\r\n]*+")
_LINE_END = re.compile(r"\r\n?|\n")
_TOKEN = re.compile(r"\s*+([()]|\?[^\s()?]*+|[^\s()?]++)")  # "fuel-level?a" is two tokens, as in IPC files
_BRACKET = re.compile(r"\([^():]*+\)|[()]")  # a flat list counts as one bracket: most of a task is flat atoms
_KEYWORD = re.compile(r"\(\s*+(:[^\s()?]*+)")
_SECTIONS = frozenset(
    (":action", ":constants", ":functions", ":goal", ":init", ":metric", ":objects", ":predicates", ":types")
)


@dataclass(frozen=True, slots=True)
class PDDLWarning:
    """Something in a file that this package understands, though a stricter tool may not.

    Examples
    --------
    >>> print(PDDLWarning("':typing' is used but not required", path="domain.pddl", line=2, column=3))
    domain.pddl:2:3: ':typing' is used but not required
    """

    message: str
    path: str | Path | None
    line: int
    column: int

    def __str__(self) -> str:
        return str(PDDLError(self.message, path=self.path, line=self.line, column=self.column))


Warn = Callable[[PDDLWarning], None]


class Source:
    """The text of one file in lower case and without comments; each character keeps its line and column."""

    __slots__ = ("_line_starts", "_warn", "path", "text")

    def __init__(self, text: str, path: str | Path | None, warn: Warn | None) -> None:
        self.path = path
        self.text = _lower(_COMMENT.sub("", text.removeprefix("\ufeff")))
        self._warn = warn
        self._line_starts: list[int] | None = None

    def position(self, offset: int) -> tuple[int, int]:
        """Give line and column of an offset, both counted from 1."""
        if self._line_starts is None:
            self._line_starts = [0, *(match.end() for match in _LINE_END.finditer(self.text))]
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def error(self, message: str, offset: int, kind: type[PDDLError] = PDDLError) -> PDDLError:
        """Make the error that says what is wrong at an offset."""
        line, column = self.position(offset)
        return kind(message, path=self.path, line=line, column=column)

    def warn(self, message: str, offset: int) -> None:
        """Tell whoever listens that something at an offset is doubtful."""
        if self._warn is not None:
            self._warn(PDDLWarning(message, self.path, *self.position(offset)))

    def sections(self) -> list[int]:
        """Check the brackets of ``(define (...) ...)`` once; give the offset of each list directly inside.

        Raises
        ------
        PDDLError
            If brackets don't match, lists are nested deeper than `MAX_NESTING`, or there is text before,
            after or between the lists.
        """
        spans, stop = self._spans()
        head = Cursor(self, 0)
        head.take_bracket("(")
        if head.ahead != "define":
            raise head.error(f"expected 'define', not {head.shown}")
        head.take()
        begin = head.taken + len("define")
        for start, end in (*spans, (stop - 1, stop)):
            between = self.text[begin:start]
            if stray := between.strip():
                raise self.error(f"unexpected '{stray.split()[0]}'", begin + between.index(stray))
            begin = end
        if trailing := self.text[stop:].lstrip():
            raise self.error("text after the end of '(define ...)'", len(self.text) - len(trailing))
        return [begin for begin, _ in spans]

    def _spans(self) -> tuple[list[tuple[int, int]], int]:
        """Find the lists at depth 2, and where the outermost one ends."""
        text, spans, opened = self.text, list[tuple[int, int]](), list[int]()
        for match in _BRACKET.finditer(text):
            start, end = match.span()
            depth = len(opened)
            if end - start > 1 and depth > 1:
                continue
            if text[start] == "(":
                if depth >= MAX_NESTING:
                    raise self.error(f"lists are nested deeper than {MAX_NESTING}", start)
                if depth > 1 and (keyword := _KEYWORD.match(text, start)) and keyword[1] in _SECTIONS:
                    raise self.error(f"a ')' is missing before '{keyword[1]}'", start)
                opened.append(start)
            if text[end - 1] == ")":
                if not opened:
                    raise self.error("')' without a '(' before it", start)
                begin = opened.pop()
                if not opened:
                    return spans, end
                if len(opened) == 1:
                    spans.append((begin, end))
        if opened:
            raise self.error("this '(' is never closed", opened[-1])
        first = len(text) - len(text.lstrip())
        raise self.error("expected '(define ...)'", first if first < len(text) else 0)


class Cursor:
    """One token of look-ahead over a source: `ahead` is the next one, `start` its offset.

    Once the brackets have been checked, every open list ends, so no method needs to mind the end of the text
    but says something sensible there nonetheless.
    """

    __slots__ = ("_end", "ahead", "source", "start", "taken")

    def __init__(self, source: Source, offset: int) -> None:
        self.source = source
        self.taken = offset  # offset of the token last taken
        self.seek(offset)

    @property
    def shown(self) -> str:
        """The next token as error messages show it."""
        return f"'{self.ahead}'" if self.ahead else "the end of the file"

    def closes(self) -> bool:
        """Say whether the list that is being read ends here."""
        return self.ahead == ")"

    def seek(self, offset: int) -> None:
        """Go on with the first token at or after an offset."""
        match = _TOKEN.match(self.source.text, offset)
        if match is None:
            self.ahead, self.start, self._end = "", len(self.source.text), len(self.source.text)
        else:
            self.ahead, self.start, self._end = match[1], match.start(1), match.end()

    def take(self) -> str:
        """Take the next token."""
        token = self.ahead
        self.taken = self.start
        self.seek(self._end)
        return token

    def take_bracket(self, bracket: str) -> None:
        """Take a bracket that has to be there."""
        if self.ahead != bracket:
            raise self.error(f"expected '{bracket}', not {self.shown}")
        self.take()

    def take_name(self, what: str) -> str:
        """Take a name; `what` says whose, for the message."""
        if not self.ahead or self.ahead[0] in "()?:-" or self.ahead == "=":
            raise self.error(f"expected {what}, not {self.shown}")
        return self.take()

    def take_variable(self) -> str:
        """Take a variable."""
        if self.ahead[:1] != "?" or self.ahead == "?":
            raise self.error(f"expected a variable, not {self.shown}")
        return self.take()

    def error(self, message: str, kind: type[PDDLError] = PDDLError) -> PDDLError:
        """Make an error about the next token."""
        return self.source.error(message, self.start, kind)

    def error_at_taken(self, message: str, kind: type[PDDLError] = PDDLError) -> PDDLError:
        """Make an error about the token last taken."""
        return self.source.error(message, self.taken, kind)


def _lower(text: str) -> str:
    lowered = text.lower()
    if len(lowered) == len(text):
        return lowered
    # A few letters outside ASCII grow when lowered, which would shift all columns after them.
    return "".join(small if len(small := letter.lower()) == 1 else letter for letter in text)

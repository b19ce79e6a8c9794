"""PDDL text as a stream of tokens that know their place, and the check of its brackets."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from explicable.errors import PDDLError, visible

_LONGEST_MESSAGE = 400
MAX_NESTING = 100  # far beyond any task; keeps every recursion over formulas away from Python's limit

_UNDECODED = re.compile("[\ud800-\udfff]")  # what `surrogateescape` makes of bytes that are not UTF-8
_COMMENT = re.compile(r";[^\r\n]*+")
# "fuel-level?a" is two tokens, as in IPC files; so is "-truck", since only numbers begin with a dash.
_TOKEN = re.compile(r"\s*+([()]|\?[^\s()?]*+|-(?=[^\s()?\d.-])|[^\s()?]++)")
_BRACKET = re.compile(r"[^()]*+[()]")
# Most of a task is flat atoms: within sections they are skipped, as many at once as follow each other.
_BRACKET_AFTER_ATOMS = re.compile(r"(?:[^()]*+\([^():]*+\))*+[^()]*+[()]")
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

    __slots__ = ("_warn", "path", "text")

    def __init__(self, text: str, path: str | Path | None, warn: Warn | None) -> None:
        self.path = path
        self.text = _lower(_COMMENT.sub("", text.removeprefix("\ufeff")))
        self._warn = warn
        # Comments may be in any encoding, and in old files they are.
        if not self.text.isascii() and (undecoded := _UNDECODED.search(self.text)):
            raise self.error("not UTF-8 text", undecoded.start())

    def position(self, offset: int) -> tuple[int, int]:
        """Give line and column of an offset, both counted from 1."""
        text = self.text
        line = 1 + text.count("\n", 0, offset) + text.count("\r", 0, offset) - text.count("\r\n", 0, offset)
        return line, offset - max(text.rfind("\n", 0, offset), text.rfind("\r", 0, offset))

    def error(self, message: str, offset: int, kind: type[PDDLError] = PDDLError) -> PDDLError:
        """Make the error that says what is wrong at an offset."""
        if len(message) > _LONGEST_MESSAGE:  # a name in a damaged file may be as long as the file
            message = f"{message[:_LONGEST_MESSAGE]} ..."
        line, column = self.position(offset)
        return kind(visible(message), path=self.path, line=line, column=column)

    def warn(self, message: str, offset: int) -> None:
        """Tell whoever listens that something at an offset is doubtful."""
        if self._warn is not None:
            self._warn(PDDLWarning(message, self.path, *self.position(offset)))

    def sections(self) -> Iterator[int]:
        """Go through ``(define (...) ...)`` and check its brackets; give the offset of each list inside.

        Raises
        ------
        PDDLError
            If brackets don't match, lists are nested deeper than `MAX_NESTING`, or there is text before,
            after or between the lists.
        """
        text = self.text
        head = Cursor(self, 0)
        if head.ahead != "(":
            raise head.error(f"expected '(define ...)', not {head.shown}")
        opened = [head.start]
        head.take()
        if head.ahead != "define":
            raise head.error(f"expected 'define', not {head.shown}")
        end = head.start + len("define")
        while opened:
            depth = len(opened)
            match = (_BRACKET if depth == 1 else _BRACKET_AFTER_ATOMS).match(text, end)
            if match is None:
                raise self.error("this '(' is never closed", opened[-1])
            bracket = match.end() - 1
            if depth == 1 and (stray := text[end:bracket].split(maxsplit=1)):
                raise self.error(f"unexpected '{stray[0]}'", text.index(stray[0], end))
            end = bracket + 1
            if text[bracket] == ")":
                start = opened.pop()
                if depth == 2:
                    yield start
            elif depth >= MAX_NESTING:
                raise self.error(f"lists are nested deeper than {MAX_NESTING}", bracket)
            elif depth > 1 and (keyword := _KEYWORD.match(text, bracket)) and keyword[1] in _SECTIONS:
                raise self.error(f"a ')' is missing before '{keyword[1]}'", bracket)
            else:
                opened.append(bracket)
        trailing = Cursor(self, end)
        if trailing.ahead:
            if trailing.ahead == ")":
                raise trailing.error("')' without a '(' before it")
            raise trailing.error("text after the end of '(define ...)': is there a ')' too many?")


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
        taken = self.ahead
        self.taken = self.start
        self.seek(self._end)
        return taken

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

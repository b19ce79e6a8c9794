"""The participants' language: gettext catalogues, compiled when they are first needed."""

import gettext
import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

LOCALE = Path(__file__).parent / "locale"


@dataclass(frozen=True, slots=True)
class Language:
    """A language and what turns English into it."""

    code: str
    text: Callable[[str], str]


@cache
def language(code: str) -> Language:
    """Load a language; English needs no catalogue.

    Examples
    --------
    >>> language("de").text("Yes")
    'Ja'
    >>> language("en").text("Yes")
    'Yes'
    """
    if code == "en":
        return Language(code, gettext.NullTranslations().gettext)
    from babel.messages.mofile import write_mo
    from babel.messages.pofile import read_po

    with (LOCALE / code / "LC_MESSAGES" / "study.po").open("rb") as file:
        catalogue = read_po(file, locale=code)
    compiled = io.BytesIO()
    write_mo(compiled, catalogue)
    compiled.seek(0)
    return Language(code, gettext.GNUTranslations(compiled).gettext)

"""A study's folder: how it is made, and what its database keeps about the study itself."""

import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from explicable.errors import InputError, UsageError
from explicable.first_response import builtin_maps, format_map
from explicable.model.files import write_whole
from explicable.study import schema as tables
from explicable.study.config import FILE
from explicable.study.materials import Materials, read_materials
from explicable.study.security import Keys, hash_password
from explicable.study.store import Store, migrate, sqlite_file, sqlite_url
from explicable.study.transaction import Transaction
from explicable.study.words import language as load_language

HERE = Path(__file__).parent
NUM_MAPS = 8

_RATINGS = (
    ("robot", "How much did the robot contribute to the success of the team?"),
    ("self", "How much did you contribute to the success of the team?"),
    ("again", "Would you like to work with this robot again?"),
)
_QUESTIONS = (
    (
        "What does your floor plan show?",
        ("the building before it was damaged", "the building as it is now"),
        0,
    ),
    ("What is to be done?", ("to leave the building", "to visit all marked rooms in few steps"), 1),
)


def make_folder(
    folder: Path, *, title: str | None = None, language: Literal["en", "de"] = "en", seed: int = 0
) -> list[Path]:
    """Write a study that runs as it is: file, texts, and the package's own maps; return the files.

    Raises
    ------
    UsageError
        If there is a study already.
    """
    if (folder / FILE).exists():
        raise UsageError(f"{folder} holds a study already")
    translate = load_language(language).text
    title = title or translate("Searching rooms with a robot")
    worlds = dict(list(builtin_maps("training").items())[: NUM_MAPS + 1])
    files = {f"maps/{name}.map": format_map(world) for name, world in worlds.items()}
    for text in ("consent", "instructions", "debrief"):
        files[f"texts/{text}.md"] = (HERE / "texts" / language / f"{text}.md").read_text(encoding="utf-8")
    parts = [
        (HERE / "template.toml")
        .read_text(encoding="utf-8")
        .format(title=_quoted(title)[1:-1], language=language, seed=seed)
    ]
    for question, choices, answer in _QUESTIONS:
        shown = [_quoted(translate(choice)) for choice in choices]
        parts.append(
            f"[[question]]\ntext = {_quoted(translate(question))}\n"
            f"choices = [{', '.join(shown)}]\nanswer = {shown[answer]}\n\n"
        )
    for name, text in _RATINGS:
        ends = f"low = {_quoted(translate('not at all'))}\nhigh = {_quoted(translate('very much'))}\n"
        parts.append(f'[[rating]]\nname = "{name}"\ntext = {_quoted(translate(text))}\n{ends}\n')
    for name in list(worlds)[1:]:
        parts.append(
            f'[[task]]                          # played, because it names no plan\nname = "{name}"\n'
        )
        parts.append(f'map = "maps/{name}.map"\npeople = 5                       # in each condition\n\n')
    files[FILE] = "".join(parts).rstrip() + "\n"
    for name, content in files.items():
        write_whole(folder / name, content)
    return [folder / name for name in files]


@dataclass(frozen=True, slots=True)
class Opened:
    """A study's database, brought up to date.

    ``new_password`` is the researcher's password where one has just been made; only its hash is kept.
    """

    new_password: str | None


def open_database(url: str, study_hash: str, *, renews_password: bool = False) -> Opened:
    """Make or migrate a study's database, and give it its secret and the researcher's password."""
    migrate(url)
    store = Store(url)

    def prepare(tx: Transaction) -> str | None:
        if read_setting(tx, "secret") is None:
            tx.add(tables.SETTINGS, name="secret", value=secrets.token_urlsafe(32))
        tx.remove(tables.SETTINGS, name="study")
        tx.add(tables.SETTINGS, name="study", value=study_hash)
        if read_setting(tx, "admin") is not None and not renews_password:
            return None
        password = secrets.token_urlsafe(12)
        tx.remove(tables.SETTINGS, name="admin")
        tx.add(tables.SETTINGS, name="admin", value=hash_password(password))
        return password

    try:
        return Opened(store.write(prepare))
    finally:
        store.close()


@dataclass(frozen=True, slots=True)
class OpenStudy:
    """A study with its database, for the researcher's own commands."""

    materials: Materials
    store: Store
    keys: Keys


@contextmanager
def open_study(folder: Path, database: str | None = None) -> Iterator[OpenStudy]:
    """Open a study that has been served before.

    Raises
    ------
    InputError
        If it has no database yet.
    """
    materials = read_materials(folder)
    url = database or sqlite_url(folder.resolve())
    file = sqlite_file(url)
    if file is not None and not file.exists():
        raise InputError("there are no data yet: nobody has been served", path=file)
    store = Store(url)
    try:
        yield OpenStudy(materials, store, Keys(store.read(read_secret)))
    finally:
        store.close()


def read_setting(tx: Transaction, name: str) -> str | None:
    """Return one of the study's settings."""
    row = tx.find(tables.SETTINGS, name=name)
    return None if row is None else str(row.value)


def read_secret(tx: Transaction) -> str:
    """Return the server's secret.

    Raises
    ------
    InputError
        If the database has none: `open_database` makes it.
    """
    secret = read_setting(tx, "secret")
    if secret is None:
        raise InputError("the database belongs to no study")
    return secret


def _quoted(text: str) -> str:
    """Write a TOML string."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'

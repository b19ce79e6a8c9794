"""The second language is complete, and participants never meet the first in it."""

import html
import re
from pathlib import Path

import pytest
from babel.messages.pofile import read_po
from studies import Visitor, open_study, write_study

from explicable.study.folder import make_folder
from explicable.study.materials import read_materials
from explicable.study.words import LOCALE

STUDY = Path(LOCALE).parent
RESEARCHERS = {"admin.html", "editor.html", "login.html"}  # are in English


@pytest.fixture(scope="module")
def catalogue():
    with (LOCALE / "de" / "LC_MESSAGES" / "study.po").open("rb") as file:
        return {message.id: message.string for message in read_po(file) if message.id}


def test_every_text_is_translated_with_its_fields(catalogue):
    wanted = set()
    for template in (STUDY / "templates").glob("*.html"):
        if template.name not in RESEARCHERS:
            wanted.update(re.findall(r'_\("((?:[^"\\]|\\.)*)"\)', template.read_text()))
    for module in STUDY.glob("*.py"):
        wanted.update(re.findall(r'translate\("((?:[^"\\]|\\.)*)"\)', module.read_text()))
    assert len(wanted) > 50
    assert wanted - set(catalogue) == set()
    for text, german in catalogue.items():
        assert german
        assert sorted(re.findall(r"\{\w+\}", text)) == sorted(re.findall(r"\{\w+\}", german))


def test_participants_of_a_german_study_meet_no_english(tmp_path, catalogue):
    folder = write_study(tmp_path, extra='language = "de"')
    client, _, _ = open_study(folder)
    own = {"robot", "the robot", "Start"}  # these are in the study's own texts, or in German words
    english = [text for text in catalogue if len(text) > 3 and "{" not in text and text not in own]
    with client:
        visitor = Visitor(client)
        pages = [visitor.arrive(), visitor.consent(), visitor.submit()]
        visitor.play()
        pages += [visitor.page, visitor.submit(), visitor.submit(**{"question-1": "before"})]
        for _ in range(2):
            visitor.play()
            pages.append(visitor.page)
        pages += [visitor.submit(), visitor.submit(**{"rating-robot": "3"}), client.get("/nowhere")]
    for page in pages:
        assert '<html lang="de">' in page.text
        shown = html.unescape(re.sub(r"<[^>]*>", " ", page.text))
        assert [text for text in english if re.search(rf"\b{re.escape(text)}(?!\w)", shown)] == []


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_new_study_runs_as_it_is(tmp_path, language):
    make_folder(tmp_path / "study", title='A "quoted" title\\', language=language)
    materials = read_materials(tmp_path / "study")
    materials.check()
    assert materials.study.title == 'A "quoted" title\\'
    assert len(materials.study.rating) == 3

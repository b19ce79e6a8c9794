"""What researchers get wrong is said in one line, with its place; nothing is made or lost by it."""

import json
import socket

import pytest
from studies import Visitor, open_study, write_study

from explicable.cli import run
from explicable.errors import InputError
from explicable.study.study_file import read_study


@pytest.fixture
def folder(tmp_path):
    return write_study(tmp_path / "study")


def refuse(capsys, *arguments, code=3):
    """Run a command that fails; return what it says, which is one line."""
    assert run([str(argument) for argument in arguments]) == code
    said = capsys.readouterr().err
    assert said.startswith("explicable: ")
    assert said.count("\n") == 1
    return said


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ("tasks_each = 2", "tasks_each = = 2", ":4:14: ", "not TOML"),
        ("tasks_each = 2", 'tasks_each = "2"', ":4: ", "tasks_each: "),
        ("step_s = 0.0", "step_s = -1.0", ":7: ", "play.step_s: "),
        (
            'map = "two.map"',
            'map = "two.map"\nhue = 1',
            ":25: ",
            "task.2.hue: there is no such key",
        ),
        ('name = "two"\n', "", ":22: ", "task.2.name: is missing"),
        ("tasks_each = 2", "tasks_each = " + 5000 * "9", ": ", "not TOML"),
        ("tasks_each = 2", "a = " + 5000 * "[", ": ", "not TOML"),
        ('name = "robot"', 'name = "comment"', ": ", "no rating can be called 'comment'"),
        ('name = "robot"', 'name = "check-1"', ": ", "no rating can be called 'check-1'"),
    ],
)
def test_a_wrong_study_file_is_told_with_its_line(folder, old, new, place, message):
    file = folder / "study.toml"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as refused:
        read_study(folder)
    assert str(refused.value).startswith(f"{file}{place}")
    assert message in str(refused.value)


def test_texts_and_maps_that_are_none_are_told_before_people_come(folder, capsys):
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text + '[texts]\nconsent = "consent.md"\n')
    (folder / "consent.md").write_bytes(b"Teilnahme: f\xfcr alle")
    assert "consent.md: not a text file" in refuse(capsys, "study", "serve", folder, "--port", 0)
    (folder / "study.toml").write_text(text)
    (folder / "two.map").write_bytes(b"\xff\xfe\x00")
    assert "two.map:1: not UTF-8" in refuse(capsys, "study", "serve", folder, "--port", 0)


def test_a_way_back_holds_only_what_the_platform_tells(folder):
    text = (folder / "study.toml").read_text()
    link = '[recruitment]\nplatform = "sona"\nreturn_url = "https://x.example/?c={code}&s={survey_code}"\n'
    (folder / "study.toml").write_text(text + link)
    assert read_study(folder).recruitment.platform == "sona"
    (folder / "study.toml").write_text(text + link.replace("sona", "prolific"))
    with pytest.raises(InputError, match=r"prolific tells no \{survey_code\}"):
        read_study(folder)


@pytest.mark.parametrize(
    ("url", "message"),
    [
        ("nonsense", "no address of a database"),
        ("mysql://u:secret@127.0.0.1/x", "mysql://u:***@127.0.0.1/x can't be opened"),
        ("postgresql+psycopg://u:secret@/x?host=/nowhere", "u:***@/x"),
        ("sqlite:////nowhere/at/all/x.db", "can't be opened"),
    ],
)
def test_a_wrong_database_is_told_in_a_line_without_its_password(folder, capsys, url, message):
    said = refuse(capsys, "study", "serve", folder, "--port", 0, "--database", url)
    assert message in said
    assert "secret" not in said


@pytest.mark.parametrize("command", [["status"], ["forget", "p-1", "--yes"], ["export", "-o", "data"]])
def test_looking_at_a_database_that_is_not_there_makes_none(folder, tmp_path, capsys, command):
    file = tmp_path / "none.db"
    name, *options = command
    said = refuse(capsys, "study", name, folder, *options, "--database", f"sqlite:///{file}")
    assert "there are no data yet" in said
    assert not file.exists()


def test_a_port_in_use_costs_nobody_the_password(folder, capsys):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        assert "in use" in refuse(capsys, "study", "serve", folder, "--port", taken.getsockname()[1])
    _, _, opened = open_study(folder)
    assert opened.new_password


def test_simulated_participants_say_at_once_that_there_is_no_study(folder, tmp_path, capsys):
    from explicable.study.serving import Server

    with socket.socket() as unheard:  # bound, but nobody listens
        unheard.bind(("127.0.0.1", 0))
        link = f"http://127.0.0.1:{unheard.getsockname()[1]}/"
        assert "no study answers" in refuse(capsys, "study", "simulate", folder, "-n", 1, "--url", link)
    other = write_study(tmp_path / "other", extra="seed = 5")
    with Server(other, port=0).in_background() as link:
        assert "another study" in refuse(capsys, "study", "simulate", folder, "-n", 1, "--url", link)


def test_export_and_forget_tell_what_they_did_as_json(folder, tmp_path, capsys):
    client, _, _ = open_study(folder)
    with client:
        Visitor(client).reach_tasks().play()
    assert run(["study", "export", str(folder), "-o", str(tmp_path / "data"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["rows"] == json.loads((tmp_path / "data" / "checksums.json").read_text())["rows"]
    participant = json.loads((tmp_path / "data/jsonl/participants.jsonl").read_text())["id"]
    assert run(["study", "forget", str(folder), participant, "--yes", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["rows_erased"] > 10

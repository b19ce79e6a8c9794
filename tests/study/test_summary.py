"""What researchers are told: who dropped out where, and whose answers are careless."""

import json

from studies import TASKS, Visitor, open_study, write_study

from explicable.cli import run

CHECK = """
[[check]]
text = "Please choose blue."
choices = ["red", "blue"]
answer = "blue"
"""


def status_of(folder, capsys):
    assert run(["study", "status", str(folder), "--json"]) == 0
    return json.loads(capsys.readouterr().out)["person"]


def test_drop_out_says_for_each_part_who_got_there_and_what_became_of_them(tmp_path, capsys, monkeypatch):
    extra = "max_attempts = 1\ntime_limit_min = 30"
    client, _, _ = open_study(write_study(tmp_path, extra=extra, tasks=TASKS.replace("= 2", "= 9")))
    with client:
        Visitor(client).reach_tasks().submit(decision="leave")
        silent = Visitor(client)
        silent.arrive()
        silent.consent()
        confused = Visitor(client)
        confused.arrive()
        confused.consent()
        confused.submit()
        confused.play()
        assert "not right often enough" in confused.submit(**{"question-1": "now"}).text
        import time

        now = time.time()
        monkeypatch.setattr(time, "time", lambda: now + 1860)
        through = Visitor(client).reach_tasks()
        through.play()
        through.play()
        through.submit(**{"rating-robot": "7"})
        Visitor(client).reach_tasks()
        dropout = {part.pop("part"): part for part in status_of(tmp_path, capsys)["dropout"]}
        assert [part["reached"] for part in dropout.values()] == [5, 4, 4, 3, 1, 1]
        assert dropout["instructions"] == {"reached": 5, "there": 0, "left": 0, "timed_out": 1, "excluded": 0}
        assert dropout["comprehension"]["excluded"] == 1
        assert (dropout["tasks"]["there"], dropout["tasks"]["left"]) == (1, 1)
        assert dropout["debrief"]["there"] == 1


def test_quality_tells_of_attention_checks_and_codes(tmp_path, capsys):
    client, _, opened = open_study(write_study(tmp_path, extra="", tasks=TASKS + CHECK))
    with client:
        visitor = Visitor(client).reach_tasks()
        visitor.play()
        visitor.play()
        visitor.submit(**{"rating-robot": "7", "check-1": "red"})
        (person,) = status_of(tmp_path, capsys)["quality"]
        assert (person["checks_right"], person["num_checks"]) == (0, 1)
        assert f">{person['code']}<" in visitor.page.text
        client.post("/admin/login", data={"password": opened.new_password})
        page = client.get("/admin").text
        assert person["code"] in page
        assert "0 of 1" in page


def test_the_code_by_which_a_platform_knows_its_people_is_not_exported(tmp_path, capsys):
    client, _, _ = open_study(write_study(tmp_path / "study"))
    with client:
        visitor = Visitor(client).reach_tasks()
        visitor.play()
        visitor.play()
        visitor.submit(**{"rating-robot": "7"})
    (person,) = status_of(tmp_path / "study", capsys)["quality"]
    assert run(["study", "export", str(tmp_path / "study"), "-o", str(tmp_path / "data")]) == 0
    for path in (tmp_path / "data").rglob("*"):
        if path.is_file():
            assert person["code"].encode() not in path.read_bytes()

"""What tests of commands begin with."""

import pytest
from typed_commands import explicable

LAMP_DOMAIN = """(define (domain lamp) (:requirements :strips)
  (:predicates (on) (broken))
  (:action press :parameters () :precondition (and) :effect (on)))
"""
LAMP = "(define (problem dark) (:domain lamp) (:init) (:goal (on)))"
BROKEN_LAMP = "(define (problem never) (:domain lamp) (:init) (:goal (broken)))"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder in which a user has made maps, traces, a labeller and a PDDL task."""
    folder = tmp_path_factory.mktemp("user")
    for arguments in (
        ["first-response", "generate", "--num", "5", "-o", "maps"],
        [
            "first-response",
            "simulate",
            *[f"maps/map-00{i}.map" for i in range(4)],
            "--num",
            "8",
            "-o",
            "traces.jsonl",
        ],
        ["first-response", "encode", "maps/map-004.map", "-o", "task"],
        ["train", "traces.jsonl", "-o", "labeller.json", "--bootstrap", "5"],
    ):
        done = explicable(*arguments, cwd=folder)
        assert done.code == 0, done.err
    (folder / "lamp-domain.pddl").write_text(LAMP_DOMAIN)
    (folder / "lamp.pddl").write_text(LAMP)
    (folder / "broken-lamp.pddl").write_text(BROKEN_LAMP)
    return folder

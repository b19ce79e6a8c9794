"""Settings of the whole test run."""

import signal

import pytest
from hypothesis import HealthCheck, settings

# Started in the background of a script, the tests and all programs that they start would ignore Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# The same commit gives the same result, on a busy machine too: nothing is timed, and examples are drawn from
# fixed seeds. `--hypothesis-profile=searching` draws others, on the look-out for mistakes.
settings.register_profile("searching", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("repeatable", settings.get_profile("searching"), derandomize=True)
settings.load_profile("repeatable")

LAMP_DOMAIN = """(define (domain lamp) (:requirements :strips)
  (:predicates (on) (broken))
  (:action press :parameters () :precondition (and) :effect (on)))
"""
LAMP = "(define (problem dark) (:domain lamp) (:init) (:goal (on)))"
BROKEN_LAMP = "(define (problem never) (:domain lamp) (:init) (:goal (broken)))"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder in which a user has made maps, traces, a labeller and a PDDL task."""
    from typed_commands import explicable  # beside the tests of commands: found when one of them is

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

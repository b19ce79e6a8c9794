"""Killed at random under load: every label that was acknowledged is there, exactly once."""

import pytest
from servers import Postgres, StudyServer, killing
from studies import write_study

from explicable.execution import builtin_families
from explicable.study import schema as tables
from explicable.study.folder import open_study
from explicable.study.simulation import Simulation

MANY = """
[[task]]
name = "one"
map = "one.map"
people = 100000
[[task]]
name = "two"
map = "two.map"
people = 100000
"""


def take_part(folder, database, link, is_over, at_once):
    """Let simulated participants come until it is over; return every label that was acknowledged."""
    acknowledged, seed = {}, 0
    with open_study(folder, database) as opened:
        while True:
            family = builtin_families()["myopic"]
            simulation = Simulation(link, opened.materials, opened.keys, family, seed, pace_s=0.02)
            tally = simulation.run(at_once, at_once=at_once)
            assert tally.num_finished == at_once
            for cookie, position, number, explicable in tally.labels:
                key = opened.keys.read("session", cookie), position, number - 1
                assert key not in acknowledged
                acknowledged[key] = explicable
            seed += 1
            if is_over():
                return acknowledged


def stored(folder, database):
    with open_study(folder, database) as opened:
        assignments = opened.store.read(
            lambda tx: {row.id: (row.session, row.position) for row in tx.all(tables.ASSIGNMENTS)}
        )
        labels = opened.store.read(lambda tx: tx.all(tables.LABELS))
        steps = opened.store.read(lambda tx: tx.all(tables.STEPS))
    assert len({(step.assignment, step.number) for step in steps}) == len(steps)
    return {(*assignments[label.assignment], label.number): label.explicable for label in labels}


def endure(folder, num_kills, at_once, *, database=None, workers=1):
    options = ["--workers", str(workers)] + (["--database", database] if database else [])
    server = StudyServer(folder, *options)
    server.start()

    def kill():
        server.kill()
        server.start()

    with killing(kill, num_kills, seed=1) as is_over:
        acknowledged = take_part(folder, database, server.link, is_over, at_once)
    code = server.stop()
    assert stored(folder, database) == acknowledged
    return code, len(acknowledged)


def test_nothing_is_lost_or_doubled_when_the_server_is_killed(tmp_path):
    code, num_labels = endure(write_study(tmp_path, tasks=MANY), 3, 4)
    assert code == 0  # Ctrl-C is a clean end
    assert num_labels > 50


@pytest.mark.slow
def test_nothing_is_lost_in_two_hundred_kills(tmp_path):
    endure(write_study(tmp_path, tasks=MANY), 200, 20)


@pytest.mark.slow
def test_nothing_is_lost_when_the_workers_on_postgresql_are_killed(tmp_path):
    postgres = Postgres()
    folder = write_study(tmp_path / "study", tasks=MANY)
    try:
        endure(folder, 200, 20, database=postgres.url, workers=2)
    finally:
        postgres.stop()


def test_postgresql_takes_the_place_of_the_file(tmp_path):
    postgres = Postgres()
    folder = write_study(tmp_path / "study", tasks=MANY)
    try:
        _, num_labels = endure(folder, 0, 3, database=postgres.url, workers=2)
    finally:
        postgres.stop()
    assert num_labels > 30
    assert not (folder / "study.db").exists()

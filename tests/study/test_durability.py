"""Killed at random under load: every label that was acknowledged is there, exactly once."""

import pytest
from endurance import endure
from servers import Postgres


@pytest.fixture
def postgres():
    started = Postgres()
    yield started
    started.stop()


def check(endured, num_kills):
    assert endured.num_lost == endured.num_unknown == 0
    assert endured.kills.total() == num_kills
    assert len(endured.acknowledged) > 30


def test_nothing_is_lost_or_doubled_when_the_server_is_killed(tmp_path):
    endured = endure(tmp_path / "study", 3, 4)
    check(endured, 3)
    assert endured.exit_code == 0  # Ctrl-C is a clean end


def test_nothing_is_lost_when_workers_or_the_database_are_killed(tmp_path, postgres):
    check(endure(tmp_path / "study", 5, 4, postgres=postgres, workers=2), 5)
    assert not (tmp_path / "study" / "study.db").exists()  # PostgreSQL takes the place of the file


@pytest.mark.slow
def test_nothing_is_lost_in_two_hundred_kills(tmp_path):
    check(endure(tmp_path / "study", 200, 20), 200)


@pytest.mark.slow
def test_nothing_is_lost_in_two_hundred_kills_on_postgresql(tmp_path, postgres):
    check(endure(tmp_path / "study", 200, 20, postgres=postgres, workers=2), 200)

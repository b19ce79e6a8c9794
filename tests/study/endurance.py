"""Simulated participants label while servers are killed; then all that was acknowledged is looked for."""

from collections import Counter
from dataclasses import dataclass

from servers import StudyServer, killing
from studies import write_study

from explicable.execution import builtin_families
from explicable.study import schema as tables
from explicable.study.folder import open_study
from explicable.study.simulation import Simulation

TASKS = """
[[task]]
name = "one"
map = "one.map"
people = 100000
[[task]]
name = "two"
map = "two.map"
people = 100000
"""


@dataclass(frozen=True)
class Endured:
    """What came of a run: kills by what was killed, and labels by session, task's position and step."""

    kills: Counter
    num_participants: int
    num_resent: int
    acknowledged: dict
    stored: dict
    exit_code: int

    @property
    def num_lost(self):
        """Labels that were acknowledged, and are not there or differ."""
        return sum(self.stored.get(key) is not label for key, label in self.acknowledged.items())

    @property
    def num_unknown(self):
        """Labels that are there, but that nobody was told of."""
        return len(self.stored.keys() - self.acknowledged.keys())


def endure(folder, num_kills, at_once, *, postgres=None, workers=1, seed=1):
    """Let so many participants at once take part until all kills are done, and all of them have finished.

    On SQLite the study's server is killed; on PostgreSQL by turns of chance it, one of its workers, the
    database's first process, or one of those that serve its connections.
    """
    write_study(folder, tasks=TASKS)
    database = postgres.url if postgres else None
    options = ["--workers", str(workers)] + (["--database", database] if database else [])
    with StudyServer(folder, *options) as server, open_study(folder, database) as opened:
        done, tallies = _take_part_while_killing(opened, server, postgres, num_kills, at_once, seed)
        code = server.stop()
        acknowledged = _acknowledged(tallies, opened.keys)
        stored = opened.store.read(_stored)
    return Endured(
        done,
        sum(tally.num_finished for tally in tallies),
        sum(tally.num_resent for tally in tallies),
        acknowledged,
        stored,
        code,
    )


def _take_part_while_killing(opened, server, postgres, num_kills, at_once, seed):
    """Let participants come, so many at once, until all kills are done."""
    done = Counter()

    def counted(name, kill):
        def work(rng):
            kill(rng)
            done[name] += 1

        return work

    kills = [counted("server", lambda _: server.kill())]
    if postgres:
        kills.append(counted("worker", server.kill_worker))
        kills.append(counted("database", lambda _: postgres.kill()))
        kills.append(counted("database connection", postgres.kill_backend))
    tallies, family = [], builtin_families()["myopic"]
    with killing(kills, num_kills, seed) as is_over:
        while not tallies or not is_over():
            simulation = Simulation(
                server.link, opened.materials, opened.keys, family, len(tallies), pace_s=0.02
            )
            tallies.append(simulation.run(at_once, at_once=at_once))
            assert tallies[-1].num_finished == at_once
    if postgres:
        postgres.wait()
    return done, tallies


def _acknowledged(tallies, keys):
    """Return what participants were told is stored; none of it twice."""
    found = {}
    for tally in tallies:
        for cookie, position, number, explicable in tally.labels:
            key = keys.read("session", cookie), position, number - 1
            assert key not in found
            found[key] = explicable
    return found


def _stored(tx):
    """Return what the database holds; no step and no label twice."""
    assignments = {row.id: (row.session, row.position) for row in tx.all(tables.ASSIGNMENTS)}
    steps = [(step.assignment, step.number) for step in tx.all(tables.STEPS)]
    assert len(set(steps)) == len(steps)
    labels = tx.all(tables.LABELS)
    found = {(*assignments[label.assignment], label.number): label.explicable for label in labels}
    assert len(found) == len(labels)
    events = tx.count(tables.EVENTS, "session", "request")
    assert max(events.values()) == 1
    assert sum(tx.count(tables.EVENTS, kind="labelled").values()) == len(labels)
    return found

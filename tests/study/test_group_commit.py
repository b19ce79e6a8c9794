"""Many jobs in one commit: what one does wrong is not the others' matter, and memory is never trusted."""

import threading

import pytest
from sqlalchemy.exc import IntegrityError
from studies import Visitor, open_study, write_study

from explicable.errors import UsageError
from explicable.study import schema as tables
from explicable.study.store import Store, migrate, sqlite_url


@pytest.fixture
def url(tmp_path):
    url = sqlite_url(tmp_path)
    migrate(url)
    return url


@pytest.fixture
def store(url):
    store = Store(url)
    yield store
    store.close()


def together(store, *jobs, given_up=()):
    """Submit jobs while the writer is held up, so that they share a commit; return their futures."""
    is_held, may_go_on = threading.Event(), threading.Event()

    def hold(_):
        is_held.set()
        may_go_on.wait()

    first = store.submit(hold)
    is_held.wait()
    futures = [store.submit(job) for job in jobs]
    for number in given_up:
        assert futures[number].cancel()
    may_go_on.set()
    first.result()
    return futures


def adding(name, value="0"):
    return lambda tx: tx.add(tables.SETTINGS, name=name, value=value)


def values(store):
    return store.read(lambda tx: {row.name: row.value for row in tx.all(tables.SETTINGS)})


@pytest.mark.parametrize("is_sent", [False, True], ids=["still waiting", "sent"])
def test_a_job_that_fails_leaves_nothing_of_what_it_wrote_and_the_others_alone(store, is_sent):
    def failing(tx):
        tx.add(tables.SETTINGS, name="bad", value="1")
        if is_sent:
            tx.all(tables.SETTINGS)
        raise UsageError("no")

    one, bad, two = together(store, adding("one"), failing, adding("two"))
    one.result(), two.result()
    with pytest.raises(UsageError, match="no"):
        bad.result()
    assert set(values(store)) == {"one", "two"}


def test_what_the_database_refuses_is_refused_to_the_one_who_asked(store):
    one, again, two = together(store, adding("one"), adding("one", "1"), adding("two"))
    one.result(), two.result()
    with pytest.raises(IntegrityError):
        again.result()
    assert values(store) == {"one": "0", "two": "0"}


def test_a_job_sees_what_those_before_it_in_the_same_commit_have_added(store):
    counts = [future.result() for future in together(store, *[counting] * 5)]
    assert counts == [0, 1, 2, 3, 4]


def counting(tx):
    number = len(tx.all(tables.SETTINGS))
    tx.add(tables.SETTINGS, name=str(number), value="")
    return number


def test_memory_that_is_out_of_date_does_no_harm(url, store):
    def count(tx):
        number = tx.recall("number")
        if number is None:
            number = tx.find(tables.SETTINGS, name="number").value
        tx.change(tables.SETTINGS, {"name": "number", "value": number}, value=str(int(number) + 1))
        tx.remember("number", str(int(number) + 1))

    other = Store(url)
    try:
        store.write(adding("number"))
        for writer in (store, other, other, store, store, other):
            for future in together(writer, count, count, adding(str(writer.read(counted)))):
                future.result()
    finally:
        other.close()
    assert values(store)["number"] == "12"


def counted(tx):
    return len(tx.all(tables.SETTINGS))


def test_who_gives_up_waiting_stops_nobody(store):
    one, _, two = together(store, adding("one"), adding("gone"), adding("two"), given_up=[1])
    one.result(), two.result()
    store.write(adding("three"))
    assert set(values(store)) == {"one", "two", "three"}


def test_requests_of_one_person_may_go_to_several_processes(tmp_path):
    folder = write_study(tmp_path)
    (first, url, _), (second, _, _) = open_study(folder), open_study(folder)
    with first, second:
        visitor = Visitor(first).reach_tasks()
        second.cookies.update(first.cookies)
        num_moves = 0
        visitors = visitor, Visitor.__new__(Visitor)
        visitors[1].client, visitors[1].page = second, visitor.page
        view = visitor.view()
        while view["position"] == 1:
            response = visitors[num_moves // 3 % 2].move(view)
            assert response.status_code == 200, response.text
            view, num_moves = response.json(), num_moves + 1
    store = Store(url)
    events = store.read(lambda tx: tx.all(tables.EVENTS))
    store.close()
    assert len({event.request for event in events}) == len(events)
    assert num_moves > 5

"""Live teaming: a joint plan that predicts the person, made anew when the person does something else."""

import json
import threading

from studies import Visitor, open_study, write_study

from explicable.execution import Proposal, prepare
from explicable.first_response import World, encode
from explicable.search import Outcome
from explicable.study import schema as tables
from explicable.study.game import Game, Moment
from explicable.study.store import Store
from explicable.study.teaming import LabelledPlanner, Teaming

FIRST, SECOND = ("command", "person", "c-0-2"), ("command", "person", "c-2-3")
SETTING = prepare(encode(World(("@.*.", "....", ".x.*")), "exclusive"))


class CountingPlanner:
    """Plans at least cost, and counts how often."""

    def __init__(self):
        self.num_plans = 0

    def __call__(self, situation):
        self.num_plans += 1
        truth = SETTING.truth
        way = truth.mission_way(situation.state)
        return Proposal(Outcome.SOLVED, tuple(map(truth.task.action, way)))


def play_with(orders, planner):
    teaming = Teaming(SETTING, planner)
    game, moment = Game(SETTING, "after", teaming.choose, expected=teaming.expected), Moment()
    expected = []
    while not game.is_over(moment):
        if game.question(moment) is not None:
            moment = game.answer(moment, explicable=True)
        elif game.upcoming(moment) is not None:
            moment = game.step(moment)
        else:
            expected.append(game.expected(moment.actions))
            moment = game.command(moment, orders.pop(0) if orders else expected[-1])
    return moment, expected


def test_who_does_what_was_predicted_is_planned_with_once():
    planner = CountingPlanner()
    moment, expected = play_with([], planner)
    assert planner.num_plans == 1
    assert [action for action in moment.actions if action[0] == "command"] == expected


def test_a_deviation_is_followed_and_planned_for():
    planner = CountingPlanner()
    _, expected = play_with([], CountingPlanner())
    other = SECOND if expected[0] == FIRST else FIRST
    moment, _ = play_with([other], planner)
    assert planner.num_plans > 1
    visits = [action[-1] for action in moment.actions if action[0] == "visit-room"]
    assert visits[0] == other[-1]


def test_without_a_plan_the_robot_follows_orders():
    teaming = Teaming(SETTING, lambda _: Proposal(Outcome.LIMIT))
    game = Game(SETTING, "after", teaming.choose)
    assert game.upcoming(Moment()) is None
    assert game.upcoming(game.command(Moment(), FIRST))[0] == "move"


def test_another_worker_plans_before_it_writes(tmp_path, labeller, monkeypatch):
    folder = write_study(tmp_path / "study", play='mode = "teaming"\nlabeller = "labeller.json"')
    (folder / "labeller.json").write_bytes(labeller.read_bytes())
    client, url, _ = open_study(folder)
    threads, plan = [], LabelledPlanner.__call__

    def watched(self, situation):
        threads.append(threading.current_thread().name)
        return plan(self, situation)

    with client:
        visitor = Visitor(client).reach_tasks()
        visitor.look()
        while (view := visitor.view())["phase"] != "moving":
            visitor.move(view)
    other, _, _ = open_study(folder, url=url)  # it has no plans yet
    monkeypatch.setattr(LabelledPlanner, "__call__", watched)
    other.cookies.update(client.cookies)
    with other:
        visitor.client = other
        assert visitor.move(view).status_code == 200
        view["number"] = 99  # another tab has gone on
        assert visitor.move(view).status_code == 409
    assert threads
    assert not any("writer" in thread for thread in threads)


def test_a_session_of_live_teaming(tmp_path, labeller):
    folder = write_study(tmp_path / "study", play='mode = "teaming"\nlabeller = "labeller.json"')
    (folder / "labeller.json").write_bytes(labeller.read_bytes())
    client, url, _ = open_study(folder)
    with client:
        visitor = Visitor(client).reach_tasks()
        visitor.play()
        visitor.play()
        assert visitor.heading == "Your opinion"
    store = Store(url)
    events = store.read(lambda tx: tx.all(tables.EVENTS, kind="commanded"))
    store.close()
    predictions = [json.loads(event.data)["expected"] for event in events]
    assert predictions
    assert all(prediction.startswith("(command person") for prediction in predictions)

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.execution import prepare
from explicable.first_response import World, encode
from explicable.study.game import Game, Moment, play_by_commands, replay
from explicable.study.protocol import ConflictError

WORLD = World(("@.*.", "..o.", ".x.*"))
SETTINGS = {semantics: prepare(encode(WORLD, semantics)) for semantics in ("exclusive", "persistent")}


@settings(max_examples=60)
@given(
    st.sampled_from(["exclusive", "persistent"]),
    st.sampled_from(["commanded", "autonomous"]),
    st.sampled_from(["after", "before"]),
    st.data(),
)
def test_whatever_people_do_every_step_is_legal_and_the_goal_is_reached(semantics, way, ask, data):
    setting = SETTINGS[semantics]
    game, moment = Game(setting, ask, play_by_commands(setting, way)), Moment()
    changes = 0
    while not game.is_over(moment):
        commands = game.commands(moment)
        may_wait = game.question(moment) is not None or game.upcoming(moment) is not None
        changes += 1
        if commands and (not may_wait or (changes < 30 and data.draw(st.booleans()))):
            moment = game.command(moment, data.draw(st.sampled_from(commands)))
        elif game.question(moment) is not None:
            with pytest.raises(ConflictError):
                game.step(moment)
            moment = game.answer(moment, explicable=data.draw(st.booleans()))
        else:
            with pytest.raises(ConflictError):
                game.answer(moment, explicable=True)
            moment = game.step(moment)
        assert changes < 500
    execution = setting.truth.task.execute(moment.actions)
    assert setting.truth.task.is_goal(execution.states[-1])
    for step in moment.steps:
        assert (step.label is None) == (step.agent == "person")


def test_a_visited_room_can_not_be_commanded():
    setting = SETTINGS["exclusive"]
    game, moment = Game(setting, "after", play_by_commands(setting, "commanded")), Moment()
    order = ("command", "person", "c-0-2")
    moment = game.command(moment, order)
    while order in game.commands(moment):
        moment = game.answer(game.step(moment), explicable=True)
    with pytest.raises(ConflictError, match="can't be commanded"):
        game.command(moment, order)


@pytest.mark.parametrize("semantics", ["exclusive", "persistent"])
def test_a_new_command_changes_where_the_robot_goes(semantics):
    setting = SETTINGS[semantics]
    game, moment = Game(setting, "before", play_by_commands(setting, "commanded")), Moment()
    moment = game.step(game.command(moment, ("command", "person", "c-0-2")))
    assert moment.announced is not None
    moment = game.command(moment, ("command", "person", "c-2-3"))
    assert moment.announced is None  # what was announced is withdrawn, unlabelled
    assert game.request(moment).action[-1] == "c-2-3"


def test_a_replay_shows_the_plan_and_takes_no_commands():
    setting = SETTINGS["exclusive"]
    plan = (("command", "person", "c-0-2"), ("move", "r1", "c-0-0", "c-0-1"))
    game, moment = Game(setting, "after", replay(plan), len(plan)), Moment()
    assert game.commands(moment) == ()
    moment = game.step(game.step(moment))
    assert game.upcoming(moment) is None
    moment = game.answer(moment, explicable=False)
    assert game.is_over(moment)
    assert [step.label for step in moment.steps] == [None, False]

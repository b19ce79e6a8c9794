import pytest
from disturbances import disturbed_loop, make_setting

from explicable.execution import Ending, record, replay
from explicable.execution.monitor import FINAL, Event

NUM_SETTINGS = 20


@pytest.fixture(scope="module")
def settings():
    return [make_setting(seed, ("persistent", "exclusive")[seed % 2]) for seed in range(NUM_SETTINGS)]


def check(setting, seed):
    """Play a disturbed game: it ends as it says, and no step was sent that was known to be impossible."""
    loop, robot, _ = disturbed_loop(setting, seed)
    played = loop.run()
    course = loop.course
    assert course.monitor in FINAL
    assert isinstance(played.episode.ending, Ending)
    assert (played.episode.ending is Ending.REACHED) == setting.truth.task.is_goal(course.state)
    assert len(course.steps) <= 200
    before, orders = setting.truth.task.initial_state, []
    for occurrence in course.occurrences:
        if occurrence.event is Event.ROBOT_NEXT and not occurrence.refusal:
            assert setting.truth.operator(before, occurrence.notice.action) is not None
            orders.append(occurrence.notice.action)
        before = occurrence.game_state
    sent = iter(orders)
    assert all(order in sent for order in robot.orders)  # in this order; the rest was refused
    return played


@pytest.mark.parametrize("part", range(4))
def test_disturbed_games_end_and_send_no_impossible_step(settings, part):
    endings = set()
    for seed in range(part * 75, part * 75 + 75):
        setting = settings[seed % NUM_SETTINGS]
        played = check(setting, seed)
        endings.add(played.episode.ending)
        assert (
            replay(record(played, setting.truth.task, observable=setting.truth.stage.beliefs)).differences
            == ()
        )
    assert Ending.REACHED in endings
    assert endings - {Ending.REACHED}


@pytest.mark.slow
def test_ten_thousand_disturbed_games_end(settings):
    for seed in range(1000, 11_000):
        check(settings[seed % NUM_SETTINGS], seed)

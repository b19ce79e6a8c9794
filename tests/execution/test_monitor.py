from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explicable.execution.monitor import (
    FINAL,
    TABLE,
    Command,
    Event,
    IllegalEventError,
    State,
    draw_monitor,
    react,
)


def reachable_from(state):
    found, pending = {state}, [state]
    while pending:
        here = pending.pop()
        for (before, _), (after, _) in TABLE.items():
            if before is here and after not in found:
                found.add(after)
                pending.append(after)
    return found


def test_every_state_is_reachable_and_every_living_state_can_end():
    assert reachable_from(State.DECIDING) == set(State)
    assert all(reachable_from(state) >= FINAL for state in State if state not in FINAL)


def test_every_event_and_command_occurs():
    assert {event for _, event in TABLE} == set(Event)
    assert {command for _, commands in TABLE.values() for command in commands} == set(Command)


@pytest.mark.parametrize("state", [state for state in State if state not in FINAL])
@pytest.mark.parametrize(
    "event",
    [
        Event.ABORT,
        Event.TIME_UP,
        Event.ANSWER_GIVEN,
        Event.FACT_OBSERVED,
        Event.PERSON_COMMANDED,
        Event.PERSON_IDLE,
        Event.TIME_PASSED,
        Event.AGENT_LOST,
        Event.AGENT_BACK,
    ],
)
def test_what_comes_from_outside_is_legal_in_every_living_state(state, event):
    react(state, event)


@given(st.lists(st.sampled_from(Event), max_size=30))
def test_books_stay_balanced_under_any_events(events):
    """Steps are sent one at a time, the planner runs exactly while planning, the end is the end."""
    state, robot_busy, planner_busy = State.DECIDING, False, False
    for event in events:
        if (state, event) not in TABLE:
            with pytest.raises(IllegalEventError):
                react(state, event)
            continue
        assert state not in FINAL
        # What several do at once, and that all of it is done before the plan is made, `Course` sees to.
        ended = (Event.STEP_FINISHED, Event.STEP_FAILED, Event.AGENT_LOST)
        robot_busy &= event not in ended and state is not State.DISPATCHING
        planner_busy &= event not in (Event.PLAN_READY, Event.PLANNER_FAILED, Event.NO_PLAN_EXISTS)
        state, commands = react(state, event)
        for command in commands:
            if command is Command.SEND_STEP:
                assert not robot_busy
                robot_busy = state is not State.DISPATCHING
            if command is Command.REQUEST_PLAN:
                assert not planner_busy
                planner_busy = True
            # Asked to give its step up, the robot still has to say that it has, unless all is over.
            robot_busy &= command is not Command.CANCEL_STEP or state not in FINAL
            planner_busy &= command is not Command.CANCEL_PLANNER
        assert robot_busy == (state in (State.ACTING, State.BRIDGING))
        assert planner_busy == (state in (State.PLANNING, State.BRIDGING))


def test_the_diagram_shows_every_change_of_state():
    drawn = draw_monitor()
    changes = sum(before is not after for (before, _), (after, _) in TABLE.items())
    assert drawn.count("-->") == changes + 1 + len(FINAL)


def test_the_page_shows_the_diagram_as_it_is():
    page = Path(__file__).parents[2] / "docs" / "execution.md"
    assert f"```mermaid\n{draw_monitor()}```\n" in page.read_text()

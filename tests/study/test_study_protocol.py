import pytest
from hypothesis import given
from hypothesis import strategies as st

from explicable.study.protocol import ACTIVE, FINAL, TABLE, ConflictError, Event, Stage, advance


@given(st.lists(st.sampled_from(list(Event)), max_size=40))
def test_any_events_lead_along_the_table_or_nowhere(events):
    stage = Stage.CONSENT
    for event in events:
        if (stage, event) in TABLE:
            stage = advance(stage, event)
        else:
            with pytest.raises(ConflictError):
                advance(stage, event)
            assert stage in Stage


def test_every_active_stage_can_reach_an_end_and_final_ones_lead_nowhere():
    assert {stage for stage, _ in TABLE} == ACTIVE
    for start in ACTIVE:
        reached, frontier = {start}, [start]
        while frontier:
            here = frontier.pop()
            for (stage, _), after in TABLE.items():
                if stage == here and after not in reached:
                    reached.add(after)
                    frontier.append(after)
        assert Stage.DEBRIEF in reached
    for stage in FINAL:
        assert all(before != stage for before, _ in TABLE)


def test_whoever_takes_a_place_can_leave_it_and_time_out():
    for stage in ACTIVE - {Stage.CONSENT}:
        assert advance(stage, Event.LEFT) == advance(stage, Event.TIMED_OUT) == Stage.RETURNED

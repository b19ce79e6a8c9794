"""The execution monitor: what an event means in each state, as one table. Pure; `loop` has the effects.

The monitor knows neither plans nor worlds. Whoever drives it tells it what happened outside (a step finished,
the person acted, ...) and, while it is *deciding*, what the plan says next. It answers with commands to carry
out in order.
"""

from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType

from explicable.errors import UsageError


class State(StrEnum):
    """Where execution stands."""

    DECIDING = "deciding"
    ACTING = "acting"
    LISTENING = "listening"
    PLANNING = "planning"
    BRIDGING = "bridging"
    DISPATCHING = "dispatching"
    REACHED = "goal reached"
    FAILED = "failed"
    ABORTED = "aborted"


class Event(StrEnum):
    """What can happen."""

    # What the plan says, asked for while deciding.
    GOAL_HOLDS = "goal holds"
    ROBOT_NEXT = "robot next"
    PERSON_NEXT = "person next"
    TEAM_NEXT = "team next"
    PLAN_OUTDATED = "plan outdated"
    # What the planner says.
    PLAN_READY = "plan ready"
    PLANNER_FAILED = "planner failed"
    NO_PLAN_EXISTS = "no plan exists"
    # What robot, person and clock do.
    STEP_FINISHED = "step finished"
    STEP_FAILED = "step failed"
    PERSON_COMMANDED = "person commanded"
    PERSON_IDLE = "person idle"
    FACT_OBSERVED = "fact observed"
    ANSWER_GIVEN = "answer given"
    AGENT_LOST = "agent lost"
    AGENT_BACK = "agent back"
    TIME_PASSED = "time passed"
    TIME_UP = "time up"
    ABORT = "abort"


class Command(StrEnum):
    """What to do about it."""

    SEND_STEP = "send step"
    CANCEL_STEP = "cancel step"
    CANCEL_PLANNER = "cancel planner"
    REQUEST_PLAN = "request plan"
    ADOPT_PLAN = "adopt plan"
    ADOPT_SAFE_PLAN = "adopt safe plan"
    TAKE_ROBOT_STEP = "take robot step"
    TAKE_PERSON_STEP = "take person step"
    KEEP_PERSON_STEP = "keep person step"
    TAKE_FACT = "take fact"
    DROP_AGENT = "drop agent"
    TAKE_AGENT_BACK = "take agent back"
    RECORD_ANSWER = "record answer"
    ASK_PERSON = "ask person"


class IllegalEventError(UsageError):
    """An event that can't happen in this state."""


Transition = tuple[State, tuple[Command, ...]]

FINAL = frozenset((State.REACHED, State.FAILED, State.ABORTED))

TABLE: Mapping[tuple[State, Event], Transition] = MappingProxyType(
    {
        # Every step is accounted for; the plan is looked at.
        (State.DECIDING, Event.GOAL_HOLDS): (State.REACHED, ()),
        (State.DECIDING, Event.ROBOT_NEXT): (State.ACTING, (Command.SEND_STEP,)),
        (State.DECIDING, Event.PERSON_NEXT): (State.LISTENING, ()),
        (State.DECIDING, Event.TEAM_NEXT): (State.DISPATCHING, ()),
        (State.DECIDING, Event.PLAN_OUTDATED): (State.PLANNING, (Command.REQUEST_PLAN,)),
        (State.DECIDING, Event.PERSON_COMMANDED): (State.DECIDING, (Command.TAKE_PERSON_STEP,)),
        (State.DECIDING, Event.PERSON_IDLE): (State.DECIDING, ()),
        (State.DECIDING, Event.FACT_OBSERVED): (State.DECIDING, (Command.TAKE_FACT,)),
        (State.DECIDING, Event.ANSWER_GIVEN): (State.DECIDING, (Command.RECORD_ANSWER,)),
        (State.DECIDING, Event.AGENT_LOST): (State.DECIDING, (Command.DROP_AGENT,)),
        (State.DECIDING, Event.AGENT_BACK): (State.DECIDING, (Command.TAKE_AGENT_BACK,)),
        (State.DECIDING, Event.TIME_PASSED): (State.DECIDING, ()),
        (State.DECIDING, Event.TIME_UP): (State.FAILED, ()),
        (State.DECIDING, Event.ABORT): (State.ABORTED, ()),
        # The robot is about a step; what the person does meanwhile counts once it is done. A failed step
        # alone teaches nothing that a planner could use: the plan stands until a fact or a person breaks it.
        # One that takes too long is given up; that too the robot has to say.
        (State.ACTING, Event.STEP_FINISHED): (State.DECIDING, (Command.ASK_PERSON, Command.TAKE_ROBOT_STEP)),
        (State.ACTING, Event.STEP_FAILED): (State.DECIDING, ()),
        (State.ACTING, Event.PERSON_COMMANDED): (State.ACTING, (Command.KEEP_PERSON_STEP,)),
        (State.ACTING, Event.PERSON_IDLE): (State.ACTING, ()),
        (State.ACTING, Event.FACT_OBSERVED): (State.ACTING, (Command.TAKE_FACT,)),
        (State.ACTING, Event.ANSWER_GIVEN): (State.ACTING, (Command.RECORD_ANSWER,)),
        (State.ACTING, Event.AGENT_LOST): (State.DECIDING, (Command.DROP_AGENT,)),
        (State.ACTING, Event.AGENT_BACK): (State.ACTING, (Command.TAKE_AGENT_BACK,)),
        (State.ACTING, Event.TIME_PASSED): (State.ACTING, (Command.CANCEL_STEP,)),
        (State.ACTING, Event.TIME_UP): (State.FAILED, (Command.CANCEL_STEP,)),
        (State.ACTING, Event.ABORT): (State.ABORTED, (Command.CANCEL_STEP,)),
        # The plan predicts a step of the person. If it does not come, planning again would predict it again.
        (State.LISTENING, Event.PERSON_COMMANDED): (State.DECIDING, (Command.TAKE_PERSON_STEP,)),
        (State.LISTENING, Event.PERSON_IDLE): (State.DECIDING, (Command.ADOPT_SAFE_PLAN,)),
        (State.LISTENING, Event.FACT_OBSERVED): (State.DECIDING, (Command.TAKE_FACT,)),
        (State.LISTENING, Event.ANSWER_GIVEN): (State.LISTENING, (Command.RECORD_ANSWER,)),
        (State.LISTENING, Event.AGENT_LOST): (State.DECIDING, (Command.DROP_AGENT,)),
        (State.LISTENING, Event.AGENT_BACK): (State.DECIDING, (Command.TAKE_AGENT_BACK,)),
        (State.LISTENING, Event.TIME_PASSED): (State.DECIDING, (Command.ADOPT_SAFE_PLAN,)),
        (State.LISTENING, Event.TIME_UP): (State.FAILED, ()),
        (State.LISTENING, Event.ABORT): (State.ABORTED, ()),
        # The planner is at work. A plan for what has since changed is of no use: then it starts again. If it
        # is late, the robot goes on with what is left of the old plan, or does the safe thing.
        (State.PLANNING, Event.GOAL_HOLDS): (State.REACHED, (Command.CANCEL_PLANNER,)),
        (State.PLANNING, Event.PLAN_READY): (State.DECIDING, (Command.ADOPT_PLAN,)),
        (State.PLANNING, Event.PLANNER_FAILED): (State.DECIDING, (Command.ADOPT_SAFE_PLAN,)),
        (State.PLANNING, Event.NO_PLAN_EXISTS): (State.FAILED, ()),
        (State.PLANNING, Event.ROBOT_NEXT): (State.BRIDGING, (Command.SEND_STEP,)),
        (State.PLANNING, Event.PERSON_COMMANDED): (
            State.PLANNING,
            (Command.CANCEL_PLANNER, Command.TAKE_PERSON_STEP, Command.REQUEST_PLAN),
        ),
        (State.PLANNING, Event.PERSON_IDLE): (State.PLANNING, ()),
        (State.PLANNING, Event.FACT_OBSERVED): (
            State.PLANNING,
            (Command.CANCEL_PLANNER, Command.TAKE_FACT, Command.REQUEST_PLAN),
        ),
        (State.PLANNING, Event.ANSWER_GIVEN): (State.PLANNING, (Command.RECORD_ANSWER,)),
        (State.PLANNING, Event.AGENT_LOST): (
            State.PLANNING,
            (Command.CANCEL_PLANNER, Command.DROP_AGENT, Command.REQUEST_PLAN),
        ),
        (State.PLANNING, Event.AGENT_BACK): (
            State.PLANNING,
            (Command.CANCEL_PLANNER, Command.TAKE_AGENT_BACK, Command.REQUEST_PLAN),
        ),
        (State.PLANNING, Event.TIME_PASSED): (State.PLANNING, ()),
        (State.PLANNING, Event.TIME_UP): (State.FAILED, (Command.CANCEL_PLANNER,)),
        (State.PLANNING, Event.ABORT): (State.ABORTED, (Command.CANCEL_PLANNER,)),
        # The robot is about a step while the planner is at work. What changes now is planned for after it.
        (State.BRIDGING, Event.STEP_FINISHED): (
            State.PLANNING,
            (Command.ASK_PERSON, Command.TAKE_ROBOT_STEP),
        ),
        (State.BRIDGING, Event.STEP_FAILED): (State.PLANNING, ()),
        (State.BRIDGING, Event.PLAN_READY): (State.ACTING, (Command.ADOPT_PLAN,)),
        (State.BRIDGING, Event.PLANNER_FAILED): (State.ACTING, ()),
        (State.BRIDGING, Event.NO_PLAN_EXISTS): (State.FAILED, (Command.CANCEL_STEP,)),
        (State.BRIDGING, Event.PERSON_COMMANDED): (State.BRIDGING, (Command.KEEP_PERSON_STEP,)),
        (State.BRIDGING, Event.PERSON_IDLE): (State.BRIDGING, ()),
        (State.BRIDGING, Event.FACT_OBSERVED): (State.ACTING, (Command.CANCEL_PLANNER, Command.TAKE_FACT)),
        (State.BRIDGING, Event.ANSWER_GIVEN): (State.BRIDGING, (Command.RECORD_ANSWER,)),
        (State.BRIDGING, Event.AGENT_LOST): (State.DECIDING, (Command.CANCEL_PLANNER, Command.DROP_AGENT)),
        (State.BRIDGING, Event.AGENT_BACK): (State.ACTING, (Command.CANCEL_PLANNER, Command.TAKE_AGENT_BACK)),
        (State.BRIDGING, Event.TIME_PASSED): (State.BRIDGING, (Command.CANCEL_STEP,)),
        (State.BRIDGING, Event.TIME_UP): (State.FAILED, (Command.CANCEL_STEP, Command.CANCEL_PLANNER)),
        (State.BRIDGING, Event.ABORT): (State.ABORTED, (Command.CANCEL_STEP, Command.CANCEL_PLANNER)),
        # Any number of agents are about steps that don't get in each other's way; a person's step, too, is
        # sent to whatever shows it to them. A plan is made anew only when nothing is under way.
        (State.DISPATCHING, Event.GOAL_HOLDS): (State.REACHED, ()),
        (State.DISPATCHING, Event.ROBOT_NEXT): (State.DISPATCHING, (Command.SEND_STEP,)),
        (State.DISPATCHING, Event.PLAN_OUTDATED): (State.PLANNING, (Command.REQUEST_PLAN,)),
        (State.DISPATCHING, Event.STEP_FINISHED): (State.DISPATCHING, (Command.TAKE_ROBOT_STEP,)),
        (State.DISPATCHING, Event.STEP_FAILED): (State.DISPATCHING, ()),
        (State.DISPATCHING, Event.PERSON_COMMANDED): (State.DISPATCHING, (Command.TAKE_PERSON_STEP,)),
        (State.DISPATCHING, Event.PERSON_IDLE): (State.DISPATCHING, ()),
        (State.DISPATCHING, Event.FACT_OBSERVED): (State.DISPATCHING, (Command.TAKE_FACT,)),
        (State.DISPATCHING, Event.ANSWER_GIVEN): (State.DISPATCHING, (Command.RECORD_ANSWER,)),
        (State.DISPATCHING, Event.AGENT_LOST): (State.DISPATCHING, (Command.DROP_AGENT,)),
        (State.DISPATCHING, Event.AGENT_BACK): (State.DISPATCHING, (Command.TAKE_AGENT_BACK,)),
        (State.DISPATCHING, Event.TIME_PASSED): (State.DISPATCHING, (Command.CANCEL_STEP,)),
        (State.DISPATCHING, Event.TIME_UP): (State.FAILED, (Command.CANCEL_STEP,)),
        (State.DISPATCHING, Event.ABORT): (State.ABORTED, (Command.CANCEL_STEP,)),
    }
)


def react(state: State, event: Event) -> Transition:
    """Look an event up.

    Returns
    -------
    State, tuple of Command
        The state that follows, and what to do, in order.

    Raises
    ------
    IllegalEventError
        If the event can't happen in this state. Nothing has changed then.

    Examples
    --------
    >>> react(State.DECIDING, Event.ROBOT_NEXT)
    (<State.ACTING: 'acting'>, (<Command.SEND_STEP: 'send step'>,))
    """
    try:
        return TABLE[state, event]
    except KeyError:
        raise IllegalEventError(f"{event.value!r} can't happen while {state.value!r}") from None


def draw_monitor() -> str:
    """Draw the table as a Mermaid state diagram; events that change no state are left out.

    ``tools/draw_monitor.py`` draws it into the docs.

    Examples
    --------
    >>> print(draw_monitor().splitlines()[2])
        deciding --> goal_reached: goal holds
    """
    lines = ["stateDiagram-v2", f"    [*] --> {_word(State.DECIDING)}"]
    for (state, event), (after, commands) in TABLE.items():
        if state is not after:
            then = f" / {', '.join(commands)}" if commands else ""
            lines.append(f"    {_word(state)} --> {_word(after)}: {event.value}{then}")
    lines.extend(f"    {_word(state)} --> [*]" for state in State if state in FINAL)
    return "\n".join(lines) + "\n"


def _word(state: State) -> str:
    return state.value.replace(" ", "_")

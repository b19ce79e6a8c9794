"""Why a notice can't be: what the monitor's table does not know, since it knows neither plans nor worlds."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from explicable.errors import UsageError
from explicable.execution.facts import change_state
from explicable.execution.monitor import Event
from explicable.execution.notices import Notice
from explicable.execution.position import Position
from explicable.model.plan import format_action


def object_to(game: Position, notice: Notice) -> str:
    """Say why a notice can't be in a game as it stands; empty if it can."""
    object_to_event = _OBJECTIONS.get(notice.event)
    return object_to_event(game, notice) if object_to_event else ""


def _to_persons_step(game: Position, notice: Notice) -> str:
    if not game.is_step_of_person(notice.action):
        return f"{format_action(notice.action)} is no step of a person of this team"
    if not game.step_under_way and not game.allows(notice.action):
        return f"{format_action(notice.action)} is not possible now"
    return ""


def _to_sending(game: Position, notice: Notice) -> str:
    action = notice.action
    if (game.is_human(action) and not game.at_once) or not game.allows(action):
        return f"{format_action(action)} is no step that the robot can take now"
    agent = game.agent_of(action)
    return f"{agent} is about another step" if agent in game.steps_under_way else ""


def _to_several_at_once(game: Position, _: Notice) -> str:
    return "" if game.at_once else "in this game one step is taken at a time"


def _to_planning(game: Position, _: Notice) -> str:
    return "steps are under way" if game.steps_under_way else ""


def _to_goal(game: Position, _: Notice) -> str:
    return "" if game.has_reached_goal else "the goal does not hold"


def _to_plan(game: Position, notice: Notice) -> str:
    return "" if game.leads_to_goal(notice.plan) else "the plan does not lead to the goal"


def _to_end_of_step(game: Position, notice: Notice) -> str:
    under_way = game.steps_under_way
    if (under_way or game.at_once) and notice.action not in under_way.values():
        return f"{format_action(notice.action)} is not what the robot was sent to do"
    return ""


def _to_success(game: Position, notice: Notice) -> str:
    objection = _to_end_of_step(game, notice)
    if not objection and game.steps_under_way and not game.allows(notice.action):
        return f"{format_action(notice.action)} can't be done, as far as is known"
    return objection


def _to_fact(game: Position, notice: Notice) -> str:
    try:
        change_state(game.truth.stage, game.state, notice.facts)
    except UsageError as error:
        return str(error)
    return ""


def _to_answer(game: Position, notice: Notice) -> str:
    if game.asked_about(notice) is None:
        return f"there is no unanswered step {format_action(notice.action)}"
    return ""


def _to_loss(game: Position, notice: Notice) -> str:
    agents = {agent.name for agent in game.setting.problem.agents}
    return "" if notice.agent in agents - game.lost else f"no agent {notice.agent!r} could be lost"


def _to_return(game: Position, notice: Notice) -> str:
    return "" if notice.agent in game.lost else f"no agent {notice.agent!r} was lost"


_OBJECTIONS: Mapping[Event, Callable[[Position, Notice], str]] = MappingProxyType(
    {
        Event.PERSON_COMMANDED: _to_persons_step,
        Event.ROBOT_NEXT: _to_sending,
        Event.TEAM_NEXT: _to_several_at_once,
        Event.PLAN_OUTDATED: _to_planning,
        Event.GOAL_HOLDS: _to_goal,
        Event.PLAN_READY: _to_plan,
        Event.STEP_FINISHED: _to_success,
        Event.STEP_FAILED: _to_end_of_step,
        Event.FACT_OBSERVED: _to_fact,
        Event.ANSWER_GIVEN: _to_answer,
        Event.AGENT_LOST: _to_loss,
        Event.AGENT_BACK: _to_return,
    }
)

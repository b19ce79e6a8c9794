"""Why a notice can't be: what the monitor's table does not know, since it knows neither plans nor worlds."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.execution.facts import change_state
from explicable.execution.monitor import Event
from explicable.execution.notices import Notice
from explicable.model.plan import format_action

if TYPE_CHECKING:
    from explicable.execution.course import Course


def object_to(course: "Course", notice: Notice) -> str:
    """Say why a notice can't be in a game as it stands; empty if it can."""
    object_to_event = _OBJECTIONS.get(notice.event)
    return object_to_event(course, notice) if object_to_event else ""


def _to_persons_step(course: "Course", notice: Notice) -> str:
    if not course.is_step_of_person(notice.action):
        return f"{format_action(notice.action)} is no step of a person of this team"
    if not course.step_under_way and not course.allows(notice.action):
        return f"{format_action(notice.action)} is not possible now"
    return ""


def _to_sending(course: "Course", notice: Notice) -> str:
    action = notice.action
    if (course.is_human(action) and not course.at_once) or not course.allows(action):
        return f"{format_action(action)} is no step that the robot can take now"
    agent = course.agent_of(action)
    return f"{agent} is about another step" if agent in course.steps_under_way else ""


def _to_several_at_once(course: "Course", _: Notice) -> str:
    return "" if course.at_once else "in this game one step is taken at a time"


def _to_planning(course: "Course", _: Notice) -> str:
    return "steps are under way" if course.steps_under_way else ""


def _to_goal(course: "Course", _: Notice) -> str:
    return "" if course.has_reached_goal else "the goal does not hold"


def _to_plan(course: "Course", notice: Notice) -> str:
    return "" if course.leads_to_goal(notice.plan) else "the plan does not lead to the goal"


def _to_end_of_step(course: "Course", notice: Notice) -> str:
    under_way = course.steps_under_way
    if (under_way or course.at_once) and notice.action not in under_way.values():
        return f"{format_action(notice.action)} is not what the robot was sent to do"
    return ""


def _to_success(course: "Course", notice: Notice) -> str:
    objection = _to_end_of_step(course, notice)
    if not objection and course.steps_under_way and not course.allows(notice.action):
        return f"{format_action(notice.action)} can't be done, as far as is known"
    return objection


def _to_fact(course: "Course", notice: Notice) -> str:
    try:
        change_state(course.truth.stage, course.state, notice.facts)
    except UsageError as error:
        return str(error)
    return ""


def _to_answer(course: "Course", notice: Notice) -> str:
    if course.asked_about(notice) is None:
        return f"there is no unanswered step {format_action(notice.action)}"
    return ""


def _to_loss(course: "Course", notice: Notice) -> str:
    agents = {agent.name for agent in course.setting.problem.agents}
    return "" if notice.agent in agents - course.lost else f"no agent {notice.agent!r} could be lost"


def _to_return(course: "Course", notice: Notice) -> str:
    return "" if notice.agent in course.lost else f"no agent {notice.agent!r} was lost"


_OBJECTIONS: Mapping[Event, Callable[["Course", Notice], str]] = MappingProxyType(
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

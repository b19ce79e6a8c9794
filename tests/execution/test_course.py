"""What a game answers to events that can't be, and to facts that are news."""

import pytest
from hospital import hospital

from explicable.execution import Course, Ending, Notice, observable_facts, prepare
from explicable.execution.monitor import Command, Event, State
from explicable.execution.robots import Fact
from explicable.first_response import World, encode
from explicable.model.grounding import ground_team

COMMAND, OTHER = ("command", "person", "c-0-2"), ("command", "person", "c-1-0")
EAST, VISIT = ("move", "r1", "c-0-0", "c-0-1"), ("visit-room", "r1", "c-1-0")
SOUTH = ("move", "r1", "c-0-0", "c-1-0")


@pytest.fixture
def course():
    problem = encode(World(("@.*", "*..")), "exclusive")
    return Course(prepare(problem, observable_facts(problem)))


def tell(course, event, action=(), **rest):
    """Bring a notice in; return why it was refused, empty if it was not."""
    number = len(course.occurrences)
    course.apply(Notice(event, action, **rest), float(number))
    assert len(course.occurrences) == number + 1
    return course.occurrences[-1].refusal


def send(course, action):
    assert not tell(course, Event.ROBOT_NEXT, action)


REFUSED = {
    "a step finished that nobody sent": (Event.STEP_FINISHED, EAST),
    "a plan that nobody asked for": (Event.PLAN_READY, ()),
    "an agent that there is not": (Event.PERSON_COMMANDED, ("command", "nobody", "c-0-2")),
    "a room that there is not": (Event.PERSON_COMMANDED, ("command", "person", "c-9-9")),
    "a person who takes a robot's step": (Event.PERSON_COMMANDED, EAST),
    "a person who does nothing in particular": (Event.PERSON_COMMANDED, ()),
    "an answer about a step that was not taken": (Event.ANSWER_GIVEN, EAST),
    "a robot's step that is not possible": (Event.ROBOT_NEXT, ("move", "r1", "c-0-1", "c-0-2")),
    "a robot's step that is a person's": (Event.ROBOT_NEXT, COMMAND),
    "a goal that does not hold": (Event.GOAL_HOLDS, ()),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cant_be_is_refused_and_changes_nothing(course, name):
    before = (course.monitor, course.state, course.mind, course.plan, list(course.steps), course.situation)
    assert tell(course, *REFUSED[name], answer=True)
    assert before == (course.monitor, course.state, course.mind, course.plan, course.steps, course.situation)


def test_a_visited_room_cant_be_commanded_again(course):
    tell(course, Event.PERSON_COMMANDED, OTHER)
    for action in (SOUTH, VISIT):
        send(course, action)
        assert not tell(course, Event.STEP_FINISHED, action)
    assert tell(course, Event.PERSON_COMMANDED, OTHER) == "(command person c-1-0) is not possible now"
    assert not tell(course, Event.PERSON_COMMANDED, COMMAND)


def test_duplicates_and_answers_to_other_steps_are_refused(course):
    tell(course, Event.PERSON_COMMANDED, COMMAND)
    send(course, EAST)
    assert tell(course, Event.STEP_FINISHED, SOUTH)
    assert not tell(course, Event.STEP_FINISHED, EAST)
    assert tell(course, Event.STEP_FINISHED, EAST)
    assert not tell(course, Event.ANSWER_GIVEN, EAST, answer=False)
    assert tell(course, Event.ANSWER_GIVEN, EAST, answer=True)
    assert [step.label for step in course.steps] == [None, False]


@pytest.mark.parametrize(
    "facts",
    [
        (Fact(("at", "r1", "c-0-0")), Fact(("at", "r1", "c-0-1"))),
        (Fact(("at", "r1", "moon")),),
        (Fact(("tired", "r1")),),
        (Fact(("adjacent", "c-0-0", "c-1-2")),),
    ],
    ids=["two places", "no such place", "no such predicate", "never so in this game"],
)
def test_impossible_states_are_refused(course, facts):
    before = course.state
    assert tell(course, Event.FACT_OBSERVED, facts=facts)
    assert course.state == before


def explains_its_past(course):
    """The problem that a planner is given leads, by the past that it is given, to where the game stands."""
    task = ground_team(course.situation.problem).task
    reached = task.execute(course.situation.past).states[-1]
    atoms = {atom for atom in course.truth.task.atoms(course.state) if " " not in atom[0]}
    for atom in atoms | task.atoms(reached):
        if task.holds(atom, reached) != course.truth.task.holds(atom, course.state):
            return False
    return True


def test_a_blocked_way_corrects_the_model_from_the_start(course):
    tell(course, Event.PERSON_COMMANDED, COMMAND)
    send(course, EAST)
    tell(course, Event.STEP_FINISHED, EAST)
    assert not tell(course, Event.FACT_OBSERVED, facts=(Fact(("clear", "c-0-2"), true=False),))
    assert course.situation.past == (COMMAND, EAST)
    assert ("clear", "c-0-2") not in course.situation.problem.robot.init
    assert ("clear", "c-0-2") in course.situation.problem.mental.init
    assert explains_its_past(course)
    assert course.is_outdated


@pytest.mark.parametrize(
    "facts",
    [
        (Fact(("clear", "c-0-1"), true=False),),  # where the robot has just gone
        (Fact(("at", "r1", "c-1-1")), Fact(("at", "r1", "c-0-1"), true=False)),  # not where it should be
    ],
    ids=["the past is impossible", "an effect did not come true"],
)
def test_what_the_past_does_not_explain_begins_a_new_game(course, facts):
    tell(course, Event.PERSON_COMMANDED, COMMAND)
    send(course, EAST)
    tell(course, Event.STEP_FINISHED, EAST)
    assert not tell(course, Event.FACT_OBSERVED, facts=facts)
    assert course.situation.past == ()
    assert explains_its_past(course)
    tell(course, Event.PERSON_COMMANDED, OTHER)
    assert explains_its_past(course)


def test_what_was_known_is_no_news(course):
    before = course.situation
    assert not tell(
        course, Event.FACT_OBSERVED, facts=(Fact(("clear", "c-0-1")), Fact(("at", "r1", "c-0-0")))
    )
    assert course.situation == before
    assert not course.is_outdated


def test_a_command_while_the_robot_acts_is_kept(course):
    tell(course, Event.PERSON_COMMANDED, COMMAND)
    send(course, EAST)
    assert course.apply(Notice(Event.PERSON_COMMANDED, OTHER), 2.0) == (Command.KEEP_PERSON_STEP,)
    assert course.mind.request.action == COMMAND


def test_an_unreachable_room_is_given_up(course):
    facts = tuple(Fact(("clear", cell), true=False) for cell in ("c-0-1", "c-1-1"))
    tell(course, Event.FACT_OBSERVED, facts=facts)
    tell(course, Event.PERSON_COMMANDED, COMMAND)
    tell(course, Event.PLAN_OUTDATED)
    tell(course, Event.PLANNER_FAILED)
    assert course.refused == {COMMAND}
    assert course.mind.request is None


@pytest.mark.parametrize("state", [State.FAILED, State.ABORTED])
def test_nothing_happens_after_the_end(course, state):
    tell(course, Event.TIME_UP if state is State.FAILED else Event.ABORT)
    for event in Event:
        assert tell(course, event, COMMAND)
    assert course.monitor is state
    assert course.ending() is (Ending.STUCK if state is State.FAILED else Ending.ABORTED)


def test_a_failing_step_is_put_down_to_the_most_specific_fact():
    problem = hospital()
    course = Course(prepare(problem, observable_facts(problem)))
    step = ("go", "robo", "hall", "ward")
    assert [course.conclude(step) for _ in range(3)] == [
        (),
        (),
        (Fact(("corridor", "hall", "ward"), true=False),),
    ]

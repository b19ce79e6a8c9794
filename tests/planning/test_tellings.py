"""Tellings in plans and schedules: parted from what is done, timed, and known from their end on."""

from dataclasses import replace

import pytest

from explicable.errors import PlanError
from explicable.first_response import encode, parse_map
from explicable.model.durations import Durations
from explicable.model.grounding import ground_team
from explicable.planning import Telling, conform_or_explain, part_tellings, schedule_plan
from explicable.planning.differences import FactDifference
from explicable.planning.tellings import label_told, telling_schema
from planning.floors import DETOUR, PATIENCE_S, command, floor, judge_of_progress, moves, visit

BLOCKED = FactDifference(("clear", "c-1-2"), holds=False)
TELL = ("tell", "r1", "clear", "c-1-2", "does", "not", "hold")
PLAN = (command(1, 3), *moves((1, 1), (2, 1), (2, 2), (2, 3), (1, 3)), visit(1, 3))


def test_what_is_told_is_parted_from_what_is_done_and_written_back():
    problem = floor(DETOUR).problem
    actions, (telling,) = part_tellings(problem, [PLAN[0], TELL, *PLAN[1:]])
    assert actions == PLAN
    assert telling == Telling(1, "r1", BLOCKED)
    assert telling.action == TELL
    assert part_tellings(problem, PLAN) == (PLAN, ())


@pytest.mark.parametrize(
    ("line", "says"),
    [
        (("tell",), "nobody is no robot"),
        (("tell", "person", *TELL[2:]), "person is no robot"),
        (("tell", "r9", *TELL[2:]), "r9 is no robot"),
        (("tell", "r1"), "no difference"),
        (("tell", "r1", "clear", "c-1-2", "holds"), "no difference"),
    ],
)
def test_a_telling_must_be_by_a_robot_and_about_a_difference(line, says):
    with pytest.raises(PlanError, match=says) as caught:
        part_tellings(floor(DETOUR).problem, [PLAN[0], line])
    assert caught.value.step == 2


def test_the_lines_of_a_plan_that_tells_are_scheduled_as_they_were_planned():
    team, labeller = floor(DETOUR, "exclusive"), judge_of_progress()
    options = {"alpha": 5.0, "improve_s": PATIENCE_S, "time_limit_s": PATIENCE_S}
    told = conform_or_explain(team, labeller, telling_cost=0.1, **options)
    assert len(told.tellings) == 1
    durations = Durations(schemas={"tell": 2.5})
    result = schedule_plan(
        team, told.plan.actions, durations, labeller=labeller, alpha=5.0, tellings=told.tellings
    )
    # One robot and one person, in turns: nothing overlaps, so the person knows as much at each step.
    assert tuple(str(step.step) for step in result.schedule.steps) == told.lines
    assert result.labelled.probabilities == pytest.approx(told.probabilities)
    assert result.probabilities[told.tellings[0].before_step] is None
    assert result.schedule.makespan == len(told.plan) + 2.5
    assert result.schedule.actions == told.plan.actions
    inexplicable = sum(1 - p for p in told.probabilities)
    assert result.objective == pytest.approx(result.schedule.makespan + 5.0 * inexplicable)


def test_a_telling_occupies_who_tells_and_who_listens_and_is_known_from_its_end_on():
    team = ground_team(encode(parse_map("@.x..\n#####\n@...*\n"), num_people=2))
    near, far = moves((0, 0), (0, 1)), moves((2, 0), (2, 1), (2, 2), robot="r2")
    telling = Telling(1, "r1", FactDifference(("clear", "c-0-2"), holds=False))
    # r2 is on its way already, r1 tells; what follows waits for its end, and no person commands meanwhile.
    orders = [("command", person, "c-2-4") for person in sorted(team_people(team))]
    actions = (far[0], *near, far[1], *orders)
    durations = Durations(schemas={"tell": 5.0, "move": 3.0})
    labeller = judge_of_progress()
    schedule = schedule_plan(team, actions, durations, labeller=labeller, tellings=[telling]).schedule
    starts = {step.step.action: step.start for step in schedule.steps}
    assert starts[telling.action] == starts[far[0]] == 0.0
    assert all(start >= 5.0 for action, start in starts.items() if action not in (telling.action, far[0]))
    (told,) = (step for step in schedule.steps if step.listeners)
    assert set(told.listeners) == team_people(team)
    assert set(schedule.agents) == {"r1", "r2"} | team_people(team)
    for order in schedule.linearisations():
        team.task.execute(order)
        assert telling.action not in order


def team_people(team):
    return {agent.name for agent in team.problem.agents if agent.kind == "human"}


def test_each_step_is_labelled_by_what_was_told_before_it():
    team, labeller = floor(DETOUR), judge_of_progress()
    known, nothing = frozenset({BLOCKED}), frozenset()
    untold = labeller.label(team, PLAN).probabilities
    assert label_told(team, labeller, PLAN, [nothing] * len(PLAN)).probabilities == untold
    told = label_told(team, labeller, PLAN, [nothing, *[known] * (len(PLAN) - 1)]).probabilities
    assert untold[1] < 0.5 < told[1]


def test_a_domain_may_have_an_action_of_that_name():
    problem = floor(DETOUR).problem
    own = replace(problem.robot.domain.actions[0], name="tell")
    domain = replace(problem.robot.domain, actions=(*problem.robot.domain.actions, own))
    theirs = replace(problem, robot=replace(problem.robot, domain=domain))
    assert (telling_schema(problem), telling_schema(theirs)) == ("tell", None)
    assert part_tellings(theirs, [TELL]) == ((TELL,), ())

"""Two robots and two people through the whole line; and who acts where only one file says so."""

import pytest

from explicable.execution import builtin_families, simulate_study
from explicable.labelling import Labeller
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem
from explicable.planning import (
    HumanModel,
    conform_or_explain,
    explain,
    front,
    measure,
    plan_classically,
    plan_explicably,
    rank,
)
from labelling.small_teams import courier
from planning.floors import PATIENCE_S


@pytest.fixture(scope="module")
def line():
    """The team, traces and a labeller."""
    problem = courier()
    episodes = simulate_study([problem], builtin_families()["myopic"], num_traces=6, way="commanded")
    traces = [episode.trace for episode in episodes]
    return ground_team(problem), traces, Labeller.train(traces, num_bootstrap=0)


def test_all_four_are_in_the_team_and_in_the_traces(line):
    team, traces, _ = line
    agents = {agent.name: agent.kind for agent in team.problem.agents}
    assert agents == {"r1": "robot", "r2": "robot", "h1": "human", "h2": "human"}
    assert {step.agent for trace in traces for step in trace.steps} <= agents.keys()
    for trace in traces:
        assert trace.notes["ending"] == "goal reached"
        for step in trace.steps:
            assert step.agent == step.action[1]
            assert (step.label is None) == (agents[step.agent] == "human")


def test_the_whole_line(line):
    team, traces, labeller = line
    planned = plan_explicably(team, labeller, alpha=2.0, improve_s=PATIENCE_S)
    actions = planned.plan.actions
    assert team.task.is_goal(team.task.execute(actions).states[-1])
    assert all(step.agent == step.action[1] for step in planned.plan.steps)
    labelled = labeller.label(team, actions)
    assert labelled.is_robot == tuple(step.agent in {"r1", "r2"} for step in planned.plan.steps)
    assert planned.objective == pytest.approx(
        planned.plan.cost + 2.0 * sum(1 - p for p in labelled.probabilities)
    )

    people = HumanModel.learn(traces)
    measured = measure(team, actions, labeller, [plan_classically(team).plan.actions[:1]], human_model=people)
    assert measured.reaches_goal
    assert measured.in_time
    for probability, robot in zip(measured.step_probabilities, labelled.is_robot, strict=True):
        assert (probability is not None) == robot
    # Either person can ask: the model of their choices spreads over both.
    assert [p is None for p in measured.predicted.probabilities] == list(labelled.is_robot)

    explained = explain(team, labeller, actions)
    assert [step.action for step in explained] == list(actions)
    corners = front(team, labeller, max_alpha=5.0, search_s=PATIENCE_S)
    assert all(corner.is_proved for corner in corners)
    assert min(corner.value(2.0) for corner in corners) == pytest.approx(planned.objective, abs=1e-5)
    patient = {"improve_s": PATIENCE_S, "time_limit_s": PATIENCE_S}
    told = conform_or_explain(team, labeller, alpha=2.0, telling_cost=0.1, **patient)
    assert told.objective <= planned.objective + 1e-9
    ranked = rank(team, labeller, [actions, plan_classically(team).plan.actions], 2.0, human_model=people)
    assert ranked[0].objective == pytest.approx(planned.objective)


LAMP = """(define (domain lamps) (:requirements :typing) (:types {types} lamp)
  (:predicates (lit ?l - lamp) (wanted ?l - lamp))
  (:action want :parameters (?p - {who} ?l - lamp) :effect (wanted ?l))
  (:action switch :parameters (?l - lamp) :precondition (wanted ?l) :effect (lit ?l)))"""
DARK = "(define (problem p) (:domain lamps) (:objects a - {who} l - lamp) (:init) (:goal (lit l)))"


@pytest.mark.parametrize(
    ("types", "who", "agents"),
    [
        ("human", "human", {"want": "a", "switch": "robot"}),
        ("human robot", "robot", {"want": "a", "switch": "a"}),
        ("cook - human human", "cook", {"want": "a", "switch": "robot"}),
        ("thing", "thing", {"want": "robot", "switch": "robot"}),
    ],
)
def test_one_file_says_who_acts_by_the_first_argument(types, who, agents):
    problem = parse_problem(DARK.format(who=who), parse_domain(LAMP.format(types=types, who=who)))
    plan = plan_classically(ground_team(TeamProblem(problem))).plan
    assert {step.action[0]: step.agent for step in plan.steps} == agents

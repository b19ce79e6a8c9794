import dataclasses

import numpy as np
import pytest
from hospital import DOMAIN, hospital

from explicable.errors import PlanError, UsageError
from explicable.execution.episodes import Ending, assign, judge, simulate, simulate_study
from explicable.execution.participants import Participant, builtin_families
from explicable.execution.setting import prepare
from explicable.first_response import builtin_maps, encode, generate
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem
from planning.test_differences import example

FAMILIES = builtin_families()


@pytest.mark.parametrize("semantics", ["exclusive", "persistent"])
@pytest.mark.parametrize("way", ["commanded", "autonomous"])
@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)
def test_games_on_random_maps_reach_the_goal_by_legal_steps(semantics, way, family):
    for seed in range(4):
        rng = np.random.default_rng(seed)
        problem = encode(generate(rng), semantics)
        participant = dataclasses.replace(family.draw(1, rng), initiative=way == "autonomous", readiness=0.5)
        episode = simulate(prepare(problem), participant, rng, way=way)
        assert episode.ending is Ending.REACHED
        task = ground_team(problem).task
        execution = task.execute([step.action for step in episode.trace.steps])
        assert task.is_goal(execution.states[-1])
        for step in episode.trace.steps:
            agent = problem.agent_of(step.action)
            assert step.agent == agent.name
            assert (step.label is None) == (agent.kind == "human")


def test_games_without_a_grid_reach_the_goal():
    setting = prepare(hospital())
    for horizon in ("request", "mission"):
        for seed in range(10):
            participant = Participant("simulated-1", horizon=horizon, learning=0.5, memory=0.8, readiness=0.5)
            episode = simulate(setting, participant, np.random.default_rng(seed))
            assert episode.ending is Ending.REACHED


@pytest.mark.parametrize("way", ["commanded", "autonomous"])
@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)
def test_what_serves_the_goal_only_in_the_end_is_asked_for_as_well(family, way):
    """In the survey a request is fulfilled by taking the image; what the goal lacks is that it be sent."""
    problem = example("rover-survey")
    for episode in simulate_study([problem], family, num_traces=3, way=way):
        assert episode.ending is Ending.REACHED
        asked = [step.action for step in episode.trace.steps if step.action[0] == "request"]
        assert len(set(asked)) == 5


DESK = """(define (domain desk) (:types robot human)
  (:predicates (signed) (painted) (inside ?r - robot) (open))
  (:action sign :parameters (?h - human) :effect (signed))
  (:action open-door :parameters (?h - human) :effect (open))
  (:action close-door :parameters (?h - human) :effect (not (open)))
  (:action leave :parameters (?r - robot) :precondition (and (open) (inside ?r)) :effect (not (inside ?r)))
  (:action paint :parameters (?r - robot) :precondition {needs} :effect (painted)))"""
DAY = """(define (problem day) (:domain desk) (:objects h - human r - robot)
  (:init (open) (inside r)) (:goal (and {goal})))"""


CHOICE = """(define (domain choice) (:types robot human item)
  (:predicates (asked ?i - item) (approved ?i - item) (fetched ?i - item))
  (:action ask :parameters (?h - human ?i - item) :effect (asked ?i))
  (:action approve :parameters (?h - human ?i - item) :effect (approved ?i))
  (:action fetch :parameters (?r - robot ?i - item) :precondition (asked ?i) :effect (fetched ?i)))"""
EITHER = """(define (problem either) (:domain choice) (:objects h - human r - robot x y - item)
  (:init) (:goal {goal}))"""


@pytest.mark.parametrize("way", ["commanded", "autonomous"])
@pytest.mark.parametrize(
    ("goal", "length"),
    [
        ("(or (fetched x) (fetched y))", 2),
        ("(and (fetched x) (or (asked y) (approved y)))", 3),
        ("(exists (?i - item) (approved ?i))", 1),
    ],
)
def test_one_of_several_ends_will_do(way, goal, length):
    """What ends a search where the goal leaves a choice is no step, and fulfils no request."""
    problem = parse_problem(EITHER.format(goal=goal), parse_domain(CHOICE))
    for horizon in ("request", "mission"):
        participant = Participant("simulated-1", horizon=horizon, initiative=way == "autonomous")
        team_problem = TeamProblem(problem)
        episode = simulate(prepare(team_problem), participant, np.random.default_rng(0), way=way)
        assert episode.ending is Ending.REACHED
        assert len(episode.trace.steps) == length


@pytest.mark.parametrize("way", ["commanded", "autonomous"])
@pytest.mark.parametrize(
    ("needs", "goal", "steps"),
    [
        # The robot waits for the signature, which the person does not know.
        ("(signed)", "(painted) (signed)", ["sign", "paint"]),
        # Whoever closes the door first has to open it again.
        ("(and)", "(not (inside r)) (not (open))", ["leave", "close-door"]),
    ],
)
def test_nobody_waits_for_ever_where_each_has_a_part_and_nothing_can_be_asked(way, needs, goal, steps):
    own, believed = (
        parse_problem(DAY.format(goal=goal), parse_domain(DESK.format(needs=known)))
        for known in (needs, "(and)")
    )
    for horizon in ("request", "mission"):
        who = Participant("simulated-1", horizon=horizon)
        episode = simulate(prepare(TeamProblem(own, believed)), who, np.random.default_rng(0), way=way)
        assert [step.action[0] for step in episode.trace.steps] == steps
        assert episode.ending is Ending.REACHED


@pytest.mark.parametrize("horizon", ["request", "mission"])
def test_where_nothing_can_be_asked_the_robot_goes_on_and_is_judged_by_the_mission(horizon):
    problem = hospital()
    asked = (("asked", "plaster"), ("asked", "syringe"))
    without_requests = [
        dataclasses.replace(p, init=tuple(a for a in p.init if a[0] != "needed") + asked)
        for p in (problem.robot, problem.human)
    ]
    setting = prepare(TeamProblem(*without_requests))
    episode = simulate(setting, Participant("simulated-1", horizon=horizon), np.random.default_rng(0))
    assert episode.ending is Ending.REACHED
    detour, surprise, *rest = [step.label for step in episode.trace.steps]
    assert (detour, surprise) == (False, False)
    assert all(rest)


def test_the_same_seed_gives_the_same_traces():
    maps = [encode(world, "exclusive") for world in list(builtin_maps().values())[:4]]
    first, again, other = (
        [
            episode.trace.steps
            for episode in simulate_study(maps, FAMILIES["myopic"], num_traces=6, seed=seed, way="commanded")
        ]
        for seed in (3, 3, 4)
    )
    assert first == again != other


def test_what_was_found_out_in_one_game_changes_no_other():
    maps = [encode(world, "exclusive") for world in list(builtin_maps().values())[:2]]
    participant = Participant("simulated-1", learning=0.5, readiness=0.5)
    shared = [prepare(problem) for problem in maps]
    for seed in range(3):
        for problem, setting in zip(maps, shared, strict=True):
            fresh = simulate(prepare(problem), participant, np.random.default_rng(seed))
            assert (
                fresh.trace.steps == simulate(setting, participant, np.random.default_rng(seed)).trace.steps
            )


def test_judging_a_game_again_gives_its_labels():
    setting = prepare(encode(builtin_maps()["training-01"], "exclusive"))
    participant = Participant("simulated-1", learning=1.0)
    steps = simulate(setting, participant, np.random.default_rng(0)).trace.steps
    assert judge(setting, participant, [s.action for s in steps], np.random.default_rng(5)) == steps


def test_a_plan_that_can_not_be_executed_is_refused():
    setting = prepare(hospital())
    with pytest.raises(PlanError, match=r"step 1, \(go robo hall store\)"):
        judge(
            setting, Participant("simulated-1"), [("go", "robo", "hall", "store")], np.random.default_rng(0)
        )


def test_a_game_that_goes_nowhere_ends_at_the_step_limit():
    episode = simulate(prepare(hospital()), Participant("simulated-1"), np.random.default_rng(0), max_steps=2)
    assert episode.ending is Ending.LIMIT
    assert len(episode.trace.steps) == 2


def test_a_goal_out_of_reach_ends_in_a_stated_failure():
    problem = hospital()
    locked = tuple(("locked", a, b) for a in ("hall", "ward", "lab") for b in ("store", "lab"))
    problem = dataclasses.replace(
        problem, robot=dataclasses.replace(problem.robot, init=problem.robot.init + locked)
    )
    episode = simulate(prepare(problem), Participant("simulated-1", learning=0.5), np.random.default_rng(0))
    assert episode.ending is Ending.STUCK


def test_traces_say_who_played_what_and_how_it_ended():
    maps = [encode(world, "exclusive") for world in list(builtin_maps().values())[:2]]
    episodes = simulate_study(maps, FAMILIES["mission"], num_traces=3, names=["a", "b"], way="commanded")
    assert [episode.trace.name for episode in episodes] == ["a", "b", "a"]
    for episode in episodes:
        assert episode.trace.origin == "simulated"
        assert episode.trace.annotator.startswith("simulated-mission-")
        assert episode.trace.notes["ending"] == "goal reached"
        assert episode.trace.notes["participant"]["horizon"] == "mission"
    with pytest.raises(UsageError, match="1 names for 2 problems"):
        simulate_study(maps, FAMILIES["mission"], names=["a"])


def test_what_the_robot_can_not_do_is_refused_and_the_rest_is_done():
    light = DOMAIN.replace("(in ?r ?p) (stored ?i ?p)", "(in ?r ?p) (light ?i) (stored ?i ?p)").replace(
        "(asked ?i - item)", "(asked ?i - item) (light ?i - item)"
    )
    setting = prepare(hospital(light, "(light plaster)"))
    episode = simulate(setting, Participant("simulated-1"), np.random.default_rng(0))
    assert episode.ending is Ending.STUCK
    assert ("fetch", "robo", "plaster", "store") in [step.action for step in episode.trace.steps]


def test_an_unknown_way_is_misuse():
    with pytest.raises(UsageError, match="autonomous"):
        simulate(prepare(hospital()), Participant("simulated-1"), np.random.default_rng(0), way="fast")


def test_games_are_spread_evenly():
    games = assign(16, 34)
    plays = np.bincount([problem for problem, _ in games])
    assert plays.min() >= 2
    assert plays.max() <= 3
    assert len(set(games)) == 34  # nobody plays a problem twice

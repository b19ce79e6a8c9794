import numpy as np
import pytest

from explicable.evaluation.labelled_game import LabelledGame
from explicable.evaluation.replanning import ExplicablePlanner, LearningPlanner, Prices
from explicable.evaluation.strategies import play, strategies
from explicable.execution import (
    Ending,
    ScriptedPerson,
    SimulatedPerson,
    Situation,
    adapt,
    builtin_families,
    prepare,
    run,
    simulate_study,
)
from explicable.first_response import builtin_maps, encode
from explicable.labelling import Labeller
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.features import TeamFeatures
from explicable.model.grounding import ground_team
from explicable.planning import HumanModel


@pytest.fixture(scope="module")
def labeller():
    problems = [encode(world) for world in list(builtin_maps("training").values())[:4]]
    episodes = simulate_study(problems, builtin_families()["myopic"], num_traces=8, way="commanded")
    return Labeller.train([episode.trace for episode in episodes], num_bootstrap=0)


@pytest.mark.parametrize("name", ["follower", "nearest", "ff", "explicable", "learning", "oracle"])
@pytest.mark.parametrize("family", ["myopic", "mission", "boltzmann"])
def test_every_strategy_reaches_the_goal_with_every_family(labeller, name, family):
    setting = prepare(encode(builtin_maps("test")["test-01"], "exclusive"))
    participant = builtin_families()[family].draw(1, np.random.default_rng(0))
    person = SimulatedPerson(setting, participant, np.random.default_rng(1))
    played = play(strategies(labeller)[name], setting, person)
    assert played.episode.ending is Ending.REACHED


class Certain:
    """Foresight that is sure of one request."""

    def __init__(self, request):
        self.request = request

    def predict(self):
        return {self.request: 1.0}


def test_foresight_decides_what_is_asked_next_if_it_is_dear_enough(labeller):
    world = builtin_maps("test")["test-01"]
    problem = encode(world, "exclusive")
    situation = Situation(problem, (), (), prepare(problem).truth.task.initial_state)
    for row, column in world.marks:
        request = ("command", "person", f"c-{row}-{column}")
        planner = ExplicablePlanner(labeller, Prices(gamma=1000.0), foresight=Certain(request))
        assert next(step for step in planner(situation).actions if step[0] == "command") == request


def test_what_people_did_in_traces_is_foreseen():
    """Participants ask for what is nearest; a planner that learned this lets the person ask so."""
    problems = [encode(world, "exclusive") for world in list(builtin_maps("training").values())[:8]]
    traces = [
        game.trace
        for game in simulate_study(problems, builtin_families()["myopic"], num_traces=16, way="commanded")
    ]
    labeller, human = Labeller.train(traces, num_bootstrap=0), HumanModel.learn(traces)
    for world in builtin_maps("test").values():
        problem = encode(world, "exclusive")
        situation = Situation(problem, (), (), prepare(problem).truth.task.initial_state)
        planner = ExplicablePlanner(labeller, Prices(gamma=1000.0), human_model=human)
        asked = next(step for step in planner(situation).actions if step[0] == "command")
        chances = human.next_steps(ground_team(problem))
        assert chances[asked] == max(chances.values())


def test_what_was_announced_is_kept_if_change_is_dear_and_only_then(labeller):
    given_up = []
    for world in builtin_maps("test").values():
        problem = encode(world, "exclusive")
        setting = prepare(problem)
        start = setting.truth.task.initial_state
        game = LabelledGame(TeamFeatures(ground_team(problem)), labeller)
        game.move_to(())
        best = ExplicablePlanner(labeller, improve_s=None)(Situation(problem, (), (), start)).actions
        for name in ("nearest", "ff"):
            announced = strategies(labeller)[name](setting, None)(Situation(problem, (), (), start)).actions
            situation = Situation(problem, (), announced, start)
            dear = ExplicablePlanner(labeller, Prices(beta=1000.0), improve_s=None)(situation).actions
            free = ExplicablePlanner(labeller, Prices(beta=0.0), improve_s=None)(situation).actions
            assert dear == announced
            assert free == min(announced, best, key=lambda plan: game.objective(plan, 1.0))
            given_up.append(free != announced)
    assert any(given_up)


def test_the_objective_is_that_of_the_labelled_plan_given_the_past(labeller):
    """The planner's own bookkeeping against labelling past and plan together, from the start."""

    problem = encode(builtin_maps("test")["test-03"], "exclusive")
    start = prepare(problem).truth.task.initial_state
    plan = ExplicablePlanner(labeller)(Situation(problem, (), (), start)).actions
    labelled = labeller.label(ground_team(problem), plan)
    expected = sum(1 - p for p, robot in zip(labelled.probabilities, labelled.is_robot, strict=True) if robot)
    for cut in (0, 1, 5, len(plan)):
        game = LabelledGame(TeamFeatures(ground_team(problem)), labeller)
        game.move_to(plan[: cut // 2])
        game.move_to(plan[:cut])
        assert game.objective(plan[cut:], 2.0) == pytest.approx(len(plan) - cut + 2 * expected)


@pytest.mark.parametrize(("answer", "adapts"), [(True, False), (None, False), (False, True)])
def test_the_labeller_is_adapted_where_an_answer_surprises_it_and_only_there(answer, adapts):
    problem = encode(builtin_maps("test")["test-01"], "persistent")
    setting = prepare(problem)
    # Knows nothing, so that every step is as likely to be explicable as not; which is no objection.
    zero = ConditionalRandomField.from_weights((True, False), ["step: move"], [[0, 0]], [[0, 0], [0, 0]])
    ignorant = Labeller(zero, schemas=["move"])
    planner = LearningPlanner(ExplicablePlanner(ignorant, improve_s=None))
    plan = planner(Situation(problem, (), (), setting.truth.task.initial_state)).actions
    script = [action for action in plan if problem.agent_of(action).kind == "human"]
    courses = []

    def watch(course):
        planner.see(course)
        courses.append(course)

    run(setting, planner, ScriptedPerson(setting, script, lambda _: answer), watch=watch)
    planner(courses[-1].situation)
    assert (planner.planner.judge is not None) == adapts
    if adapts:
        features = TeamFeatures(ground_team(problem))
        before, after = (
            labeller.label(features, courses[-1].situation.past).scores.f_robot_expected
            for labeller in (ignorant, planner.planner.judge)
        )
        assert after < before


def test_answers_go_with_their_steps_though_the_game_goes_on_while_a_plan_is_made(labeller):
    problem = encode(builtin_maps("test")["test-02"], "persistent")
    setting, courses, planner = prepare(problem), [], ExplicablePlanner(labeller, improve_s=None)
    plan = planner(Situation(problem, (), (), setting.truth.task.initial_state)).actions
    script = [action for action in plan if problem.agent_of(action).kind == "human"]
    person = ScriptedPerson(setting, script, lambda action: action[0] == "move")
    run(setting, planner, person, watch=courses.append)
    steps = courses[-1].steps
    for num_steps in range(len(steps) + 1):
        past = tuple(step.action for step in steps[:num_steps])
        state = setting.truth.follow(setting.truth.task.initial_state, past)
        planner = LearningPlanner(ExplicablePlanner(labeller, improve_s=None, max_evaluations=0))
        planner.see(courses[-1])
        planner(Situation(problem, past, (), state))
        if planner.planner.judge is not None:
            answers = [step.is_explicable for step in steps[:num_steps]]
            expected = adapt(labeller, TeamFeatures(ground_team(problem)), past, answers).model
            assert np.array_equal(planner.planner.judge.model.state_weights_, expected.state_weights_)
            break
    else:
        pytest.fail("no answer was a surprise")

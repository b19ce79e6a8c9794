"""The front of cost and explicability, against the search for single alphas."""

import itertools
import math
import signal
from dataclasses import replace

import numpy as np
import pytest

from explicable.errors import UsageError
from explicable.first_response.encoding import encode
from explicable.first_response.map_file import parse_map
from explicable.labelling.crf import ConditionalRandomField
from explicable.labelling.labeller import Labeller
from explicable.model.grounding import ground_team
from explicable.model.team import TeamProblem
from explicable.planning import (
    choose,
    front,
    plan_classically,
    plan_explicably,
    plan_most_explicably,
    plan_within_budget,
)
from explicable.planning.pareto import Pool
from explicable.planning.team_plan import TeamPlan
from explicable.search import Outcome, search
from oracles.plans import all_plans
from planning.floors import PATIENCE_S, SCHEMAS, floor, judge_of_progress
from planning.test_differences import example

# Two obstacles in the way: two more steps avoid the first, four more the second as well.
MAZE = "########\n#@o.o.*#\n#...#..#\n###.#.##\n###...##\n########\n"


def judge_of_breaking():
    """A labeller by hand: breaking an obstacle is inexplicable."""
    weights = {"step: move": 3.0, "step: visit-room": 3.0, "step: remove-obstacle": -3.0}
    rows = [[weight, 0.0] for weight in weights.values()]
    model = ConditionalRandomField.from_weights([True, False], list(weights), rows, [[0, 0], [0, 0]])
    return Labeller(model, schemas=SCHEMAS)


@pytest.fixture(scope="module")
def maze():
    return floor(MAZE), judge_of_breaking()


@pytest.fixture(scope="module")
def plans(maze):
    return front(*maze, max_alpha=20.0, search_s=PATIENCE_S)


def test_at_every_alpha_the_front_holds_a_plan_of_least_objective(maze, plans):
    assert [found.plan.cost for found in plans] == [7, 9, 13]
    assert all(found.is_proved for found in plans)
    for alpha in (0.01, 0.3, 1.0, 2.5, 7.0, 19.0):
        least = plan_explicably(*maze, alpha=alpha, improve_s=PATIENCE_S)
        assert least.lower_bound == pytest.approx(least.objective)
        values = [found.plan.cost + alpha * found.num_inexplicable for found in plans]
        assert min(values) == pytest.approx(least.objective, abs=1e-5)
        (best,) = (found for found in plans if found.alpha_from < alpha < found.alpha_to)
        assert best.plan.cost + alpha * best.num_inexplicable == pytest.approx(min(values))


def judge_of_both(strength):
    """Breaking an obstacle and leading away are inexplicable; like labels attract each other."""
    judge = judge_of_progress(strength)
    names = [*judge.model.feature_names_, "step: remove-obstacle"]
    rows = [*judge.model.state_weights_.tolist(), [-2.0, 0.0]]
    model = ConditionalRandomField.from_weights([True, False], names, rows, [[0.7, 0], [0, 0.7]])
    return Labeller(model, schemas=SCHEMAS)


def all_points(team, labeller, max_steps):
    """Cost and expected number of inexplicable steps of every plan of up to so many steps."""
    for operators in all_plans(team.task, max_steps):
        scores = labeller.label(team, [team.task.action(o) for o in operators]).scores
        yield len(operators), len(operators) * (1 - scores.f_expected)


def random_judge(rng):
    """A labeller with weights by chance, so that some fronts are not convex."""
    names = ["step: remove-obstacle", "step: move", "step: visit-room"]
    names += [f"request: move {word}" for word in ("nearer", "farther", "no-nearer", "no-way", "no-target")]
    rows = [[rng.uniform(-3.0, 3.0), 0.0] for _ in names]
    pull = rng.uniform(-0.5, 1.0)
    model = ConditionalRandomField.from_weights([True, False], names, rows, [[pull, 0], [0, pull]])
    return Labeller(model, schemas=SCHEMAS)


def test_the_front_holds_all_plans_to_which_none_is_preferable_between_its_corners_too():
    rng, num_between = np.random.default_rng(4), 0
    for text in ("@o*\n...\n", "@x*\n.o.\n...\n", "@.*\n.o.\n", "*@o\n..*\n") * 3:
        team, labeller = floor(text, "exclusive"), random_judge(rng)
        found = front(team, labeller, max_alpha=20.0, search_s=PATIENCE_S)
        assert all(plan.is_proved for plan in found)
        max_steps = min(found[0].plan.cost + 3, 9)
        preferable = {}
        for cost, count in sorted(all_points(team, labeller, max_steps)):
            if cost <= found[-1].plan.cost and count < min(preferable.values(), default=math.inf) - 1e-4:
                preferable[cost] = count
        within = {plan.plan.cost: plan.num_inexplicable for plan in found if plan.plan.cost <= max_steps}
        assert within == pytest.approx(preferable, abs=1e-6)
        between = [plan for plan in found if plan.alpha_from is None]
        num_between += len(between)
        for plan in between:
            assert plan.alpha_to is None
            planned = plan_within_budget(
                team,
                labeller,
                max_cost_increase=plan.plan.cost / found[0].plan.cost - 1,
                search_s=PATIENCE_S,
            )
            assert planned.plan.cost == plan.plan.cost
            least = plan_within_budget(
                team, labeller, min_explicability=plan.explicability - 1e-6, search_s=PATIENCE_S
            )
            assert least.plan.cost == plan.plan.cost
    assert num_between


def test_what_a_limit_of_cost_leaves_no_plan_for_is_no_plan(maze):
    cheapest = plan_explicably(*maze, alpha=0.0).plan.cost
    assert plan_explicably(*maze, max_cost=cheapest, improve_s=PATIENCE_S).plan.cost == cheapest
    refused = plan_explicably(*maze, max_cost=cheapest - 1)
    assert (refused.plan, refused.outcome) == (None, Outcome.LIMIT)


def test_a_known_plan_is_begun_with_and_must_be_one(maze):
    team, labeller = maze
    task, scorer = team.task, labeller.scorer(team)
    plan = search(task, "astar").operators
    result = search(task, "anytime", scorer=scorer, alpha=2.0, known_plans=[plan], max_evaluations=0)
    assert result.operators == plan
    for wrong in (plan[:-1], plan[1:], (*plan, task.num_operators), (-1,)):
        with pytest.raises(UsageError):
            search(task, "anytime", scorer=scorer, known_plans=[wrong])


@pytest.mark.parametrize(
    ("text", "strength", "max_steps", "num_corners"),
    [("@o*\n...\n", 0.5, 8, 3), ("@o*\n...\n", 1.5, 8, 2), ("@x*\n.o.\n...\n", 1.5, 9, 3)],
)
def test_the_front_is_that_of_all_plans(text, strength, max_steps, num_corners):
    team, labeller = floor(text, "exclusive"), judge_of_both(strength)
    points = set(all_points(team, labeller, max_steps))
    found = front(team, labeller, max_alpha=20.0, search_s=PATIENCE_S)
    assert len(found) == num_corners
    assert all(corner.is_proved for corner in found)
    for alpha in (*(10 ** (k / 10) for k in range(-30, 13)), *(corner.alpha_from for corner in found[1:])):
        least = min(cost + alpha * count for cost, count in points)
        assert min(corner.value(alpha) for corner in found) == pytest.approx(least, abs=1e-4)
    best = {
        min(points, key=lambda p, a=a: p[0] + a * p[1]) for a in (10 ** (k / 50) for k in range(-150, 60))
    }
    assert {corner.plan.cost for corner in found} == {cost for cost, _ in best}


def test_a_corner_that_its_own_limit_of_cost_found_ends_what_is_to_be_looked_for(plans):
    left, middle, right = (
        TeamPlan(Outcome.SOLVED, found.plan, found.labelled, None, 0.0, 0, 0.0)
        for found in (plans[0], plans[1], plans[-1])
    )
    pool = Pool()
    pool.add(left)
    pool.add(right)
    pool.add_within(middle.plan.cost, middle)
    limits = []
    while (limit := pool.next_limit()) is not None:
        limits.append(limit)
        pool.add_within(limit, middle if limit > middle.plan.cost else left)
    assert limits == sorted(set(limits), key=limits.index)
    assert all(left.plan.cost < limit < right.plan.cost for limit in limits)


def test_costs_rise_and_inexplicable_steps_fall_along_the_front(plans):
    for left, right in itertools.pairwise(plans):
        assert left.plan.cost < right.plan.cost
        assert left.num_inexplicable > right.num_inexplicable
        assert left.alpha_from < left.alpha_to == right.alpha_from
    assert (plans[0].alpha_from, plans[-1].alpha_to) == (0.0, math.inf)


def test_a_front_shows_itself_in_a_notebook(plans):
    shown = plans._repr_html_()
    assert shown.count("<meter") == len(plans)
    assert all(f"<td>{found.plan.cost}</td>" in shown for found in plans)


def test_a_budget_chooses_from_the_front(plans):
    assert choose(plans, max_cost_increase=0.0) is plans[0]
    assert choose(plans, max_cost_increase=100.0) is plans[-1]
    assert choose(plans, min_explicability=0.0) is plans[0]
    assert choose(plans, min_explicability=plans[-1].explicability) is not None
    assert choose(plans, min_explicability=1.0) is None
    assert choose(plans, min_explicability=1.0, max_cost_increase=1.0) is None
    assert choose((), max_cost_increase=1.0) is None


@pytest.mark.parametrize(
    "budget", [{"max_cost_increase": 0.3}, {"min_explicability": 0.9}, {"max_cost_increase": 0.0}]
)
def test_planning_within_a_budget_is_choosing_from_the_front(maze, plans, budget):
    chosen = choose(plans, **budget)
    planned = plan_within_budget(*maze, search_s=PATIENCE_S, **budget)
    assert planned.plan.cost == chosen.plan.cost
    assert planned.objective == pytest.approx(chosen.value(planned.alpha))
    assert planned.lower_bound == planned.objective
    assert plan_within_budget(*maze, min_explicability=1.0).outcome is Outcome.LIMIT


@pytest.mark.parametrize(
    "budget",
    [
        {},
        {"max_cost_increase": -0.1},
        {"max_cost_increase": math.inf},
        {"max_cost_increase": math.nan},
        {"min_explicability": 1.1},
        {"min_explicability": math.nan},
    ],
)
def test_budgets_without_meaning_are_refused(plans, budget):
    with pytest.raises(UsageError):
        choose(plans, **budget)


@pytest.mark.parametrize("alpha", [0.0, -1.0, math.inf, math.nan])
def test_the_largest_alpha_must_be_a_price(maze, alpha):
    with pytest.raises(UsageError, match="alpha"):
        front(*maze, max_alpha=alpha)


def test_no_plan_no_front():
    problem = encode(parse_map(MAZE))
    nowhere = replace(problem.robot, init=tuple(fact for fact in problem.robot.init if fact[0] != "at"))
    team = ground_team(TeamProblem(nowhere, problem.human))
    assert front(team, judge_of_breaking()) == ()
    within = plan_within_budget(team, judge_of_breaking(), max_cost_increase=0.1)
    assert (within.plan, within.outcome) == (None, Outcome.UNSOLVABLE)


class PressesCtrlC:
    """A labeller at whose so-many-th question Ctrl-C is pressed: in the midst of the planner's Python."""

    def __init__(self, labeller, question):
        self._labeller, self._left = labeller, question

    def scorer(self, *arguments, **options):
        self._left -= 1
        if self._left == 0:
            signal.raise_signal(signal.SIGINT)
        return self._labeller.scorer(*arguments, **options)

    def __getattr__(self, name):
        return getattr(self._labeller, name)


@pytest.fixture
def rovers():
    team, labeller = ground_team(example("rover-survey")), judge_of_progress()
    labeller.schemas = tuple(schema.name for schema in team.problem.robot.domain.actions)
    return team, labeller


def test_a_front_that_is_interrupted_ends_with_what_was_found(rovers):
    team, labeller = rovers
    found = front(team, PressesCtrlC(labeller, question=2), search_s=0.01)
    assert found
    assert not any(corner.is_proved for corner in found)


def test_ctrl_c_at_a_better_plan_ends_the_improvement_with_that_plan(rovers):
    values = []

    def press(value):
        values.append(value)
        signal.raise_signal(signal.SIGINT)

    found = plan_explicably(*rovers, alpha=10.0, improve_s=3600.0, on_better=press)
    assert found.outcome is Outcome.INTERRUPTED
    assert found.objective <= min(values) + 1e-9
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_ctrl_c_before_the_first_plan_leaves_none(rovers):
    team, labeller = rovers
    found = plan_explicably(team, PressesCtrlC(labeller, question=1))
    assert (found.outcome, found.plan) == (Outcome.INTERRUPTED, None)
    with pytest.raises(KeyboardInterrupt):
        front(team, PressesCtrlC(labeller, question=1), search_s=0.0)


def test_orders_of_the_goals_that_cost_too_much_are_left_alone():
    team, labeller = ground_team(example("warehouse")), judge_of_progress()
    labeller.schemas = tuple(schema.name for schema in team.problem.robot.domain.actions)
    cheapest = plan_classically(
        team, labeller=labeller, algorithm="anytime", max_evaluations=20_000
    ).plan.cost
    within = plan_most_explicably(team, labeller, cheapest, improve_s=3.0)
    assert within.plan.cost <= cheapest

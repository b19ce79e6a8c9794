"""Conform or explain: the least J over plans that may tell, against enumeration; extremes of the price."""

import itertools
import math
from types import SimpleNamespace

import pytest

from explicable.errors import UsageError
from explicable.model.team import TeamTask
from explicable.planning import deadline
from explicable.planning.differences import FactDifference, find_differences
from explicable.planning.explanation import tell
from explicable.planning.telling import conform_or_explain
from explicable.search import Outcome
from planning.floors import DETOUR, PATIENCE_S, command, floor, judge_of_progress, moves, visit

BLOCKED = FactDifference(("clear", "c-1-2"), holds=False)
OPTIONS = {"alpha": 5.0, "improve_s": PATIENCE_S, "time_limit_s": PATIENCE_S}


def least_objective(team, labeller, alpha, telling_cost, max_told):
    """J of the best plan that may tell: all plans, with all tellings in all places."""
    differences = find_differences(team.problem)
    subsets = itertools.chain.from_iterable(
        itertools.combinations(range(len(differences)), size) for size in range(max_told + 1)
    )
    people = {
        frozenset(told): labeller.scorer(tell(team, [differences[number] for number in told]))
        for told in subsets
    }
    task, best = team.task, math.inf
    pending = [(task.initial_state, people[frozenset()].root(task.initial_state), 0.0, frozenset())]
    while pending:
        longer = []
        for state, context, cost, told in pending:
            if task.is_goal(state):
                best = min(best, cost + alpha * people[told].score(context, state, [])[0])
            for step in task.applicable(state):
                after = task.successor(state, step)
                extended = people[told].extend(context, step, state, after)
                longer.append((after, extended, cost + task.cost(step), told))
            one_more = (more for more in people if told < more and len(more) == len(told) + 1)
            longer += [(state, context, cost + telling_cost, more) for more in one_more]
        pending = [node for node in longer if node[2] < best]
        assert len(pending) < 300_000
    return best


@pytest.mark.parametrize("text", ["@x\n.*\n", "@.\n*x\n"])
@pytest.mark.parametrize("semantics", ["persistent", "exclusive"])
@pytest.mark.parametrize(("alpha", "telling_cost"), [(1.5, 0.3), (5.0, 0.3), (1.5, 5.0), (1.0, 0.0)])
def test_the_least_objective_is_found_and_proved(text, semantics, alpha, telling_cost):
    team, labeller = floor(text, semantics), judge_of_progress(strength=1.0)
    prices = {"alpha": alpha, "telling_cost": telling_cost, "max_told": 1}
    result = conform_or_explain(team, labeller, **{**OPTIONS, **prices})
    assert result.is_complete
    assert result.objective == pytest.approx(least_objective(team, labeller, **prices))
    assert result.lower_bound == pytest.approx(result.objective)
    inexplicable = sum(1 - p for p in result.probabilities)
    assert result.objective == pytest.approx(
        result.plan.cost + alpha * inexplicable + telling_cost * len(result.told)
    )


def test_cheap_telling_is_a_step_of_the_plan_and_dear_telling_is_not():
    team, labeller = floor(DETOUR, "exclusive"), judge_of_progress()
    told = conform_or_explain(team, labeller, telling_cost=0.1, **OPTIONS)
    assert told.told == (BLOCKED,)
    assert told.is_complete
    assert told.objective < told.objective_untold
    (telling,) = told.tellings
    assert telling.agent == "r1"
    assert told.lines[telling.before_step] == str(telling) == "(tell r1 clear c-1-2 does not hold)"
    assert len(told.lines) == len(told.plan) + 1
    before = labeller.label(team, told.plan.actions).probabilities[telling.before_step]
    assert before < 0.5 <= told.probabilities[telling.before_step]  # it makes the next step expected
    silent = conform_or_explain(team, labeller, telling_cost=1000.0, **OPTIONS)
    assert silent.tellings == ()
    assert silent.objective == silent.objective_untold == pytest.approx(told.objective_untold)


def test_without_a_difference_or_a_plan_there_is_nothing_to_tell():
    same = conform_or_explain(floor(DETOUR.replace("x", ".")), judge_of_progress(), **OPTIONS)
    assert same.told == ()
    assert same.is_complete
    team = floor(DETOUR)
    nowhere = team.task.with_goal([("at", "r1", "c-9-9")])
    none = conform_or_explain(type(team)(team.problem, nowhere, team.mental), judge_of_progress(), **OPTIONS)
    assert (none.outcome, none.plan, none.objective, none.lines) == (Outcome.UNSOLVABLE, None, None, ())


def test_out_of_time_the_best_so_far_is_given(monkeypatch):
    clock = itertools.chain([0, 0], itertools.repeat(PATIENCE_S))  # after the first plan the time is up
    monkeypatch.setattr(deadline, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    late = conform_or_explain(floor(DETOUR), judge_of_progress(), **OPTIONS)
    assert late.outcome is Outcome.SOLVED
    assert late.objective == late.objective_untold
    assert not late.is_complete
    assert late.plan.actions[0] == command(1, 3) or late.plan.actions[0] in moves((1, 1), (2, 1))
    assert late.plan.actions[-1] == visit(1, 3)


@pytest.mark.parametrize("max_sets", [64, 1])  # 1: explaining puts in order what could be told
def test_what_is_seen_of_a_task_is_measured_once(max_sets):
    team, labeller = floor(DETOUR), judge_of_progress()
    measured, features = [], labeller.features

    def noted(seen):
        measured.extend([seen] if isinstance(seen, TeamTask) else [])
        return features(seen)

    labeller.features = noted
    result = conform_or_explain(team, labeller, max_told=1, max_sets=max_sets, **OPTIONS)
    assert result.is_complete == (max_sets > 1)
    assert sum(one is team for one in measured) == 1


@pytest.mark.parametrize(
    "options", [{"alpha": -1.0}, {"telling_cost": math.nan}, {"telling_cost": math.inf}, {"max_told": -1}]
)
def test_prices_without_meaning_are_refused(options):
    with pytest.raises(UsageError):
        conform_or_explain(floor(DETOUR), judge_of_progress(), **options)

"""The grounded task as Python sees it: states, look-ups, execution, and the arrays behind."""

import subprocess
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable import _core
from explicable.errors import PlanError, UsageError
from explicable.model.grounding import ground
from explicable.pddl import parse_domain, parse_problem

DOMAIN = """
(define (domain rooms)
  (:requirements :typing :negative-preconditions :disjunctive-preconditions :action-costs)
  (:types robot room)
  (:predicates (at ?r - robot ?x - room) (door ?x ?y - room) (locked ?x - room) (seen ?x - room))
  (:functions (total-cost) (length ?x ?y - room))
  (:action move :parameters (?r - robot ?x ?y - room)
    :precondition (and (at ?r ?x) (not (locked ?y)) (or (door ?x ?y) (door ?y ?x)))
    :effect (and (at ?r ?y) (not (at ?r ?x)) (increase (total-cost) (length ?x ?y))))
  (:action unlock :parameters (?r - robot ?x - room)
    :precondition (locked ?x) :effect (and (not (locked ?x)) (increase (total-cost) 7)))
  (:action look :parameters (?r - robot ?x - room)
    :precondition (at ?r ?x) :effect (and (seen ?x) (increase (total-cost) 1))))
"""
PROBLEM = """
(define (problem house) (:domain rooms)
  (:objects r1 - robot hall kitchen cellar - room)
  (:init (at r1 hall) (door hall kitchen) (door kitchen cellar) (locked cellar)
         (= (length hall kitchen) 2) (= (length kitchen hall) 2)
         (= (length kitchen cellar) 3) (= (length cellar kitchen) 3))
  (:goal (seen cellar)) (:metric minimize (total-cost)))
"""
PLAN = [
    ("move", "r1", "hall", "kitchen"),
    ("unlock", "r1", "cellar"),
    ("move", "r1", "kitchen", "cellar"),
    ("look", "r1", "cellar"),
]


@pytest.fixture(scope="module")
def task():
    return ground(parse_problem(PROBLEM, parse_domain(DOMAIN)))


def test_plan_is_executed(task):
    execution = task.execute(PLAN)
    assert execution.cost == 13
    assert [task.action(operator) for operator in execution.operators] == PLAN
    assert [task.is_goal(state) for state in execution.states] == [False] * 4 + [True]
    assert task.atoms(execution.states[-1]) == {("at", "r1", "cellar"), ("seen", "cellar")}
    assert hash(execution.states[0]) == hash(task.initial_state)


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        (PLAN[:1] + PLAN[2:], r"step 2, \(move r1 kitchen cellar\), lacks \(not \(locked cellar\)\)"),
        (PLAN[1:], r"step 2, .*, lacks \(at r1 kitchen\)"),
        ([("move", "r1", "hall", "cellar")], r"step 1, .*, lacks \(not \(locked cellar\)\)"),
        ([PLAN[1], ("move", "r1", "hall", "cellar")], r"step 2, .*, lacks \(or \(door hall cellar\)"),
        ([("fly", "r1")], "no action of the domain"),
        ([("look", "r1")], "1 arguments instead of 2"),
        ([("look", "r9", "hall")], "unknown object, r9"),
        ([("look", "hall", "hall")], r"lacks \(robot hall\)"),
    ],
)
def test_impossible_step_is_named_with_what_it_lacks(task, steps, message):
    with pytest.raises(PlanError, match=message):
        task.execute(steps)


def test_look_ups_answer_unknown_names_with_nothing(task):
    assert task.operators_of(("move", "r1", "hall", "nowhere")) == ()
    assert task.operators_of(("dance",)) == ()
    assert task.operators_of(()) == ()
    assert task.fact_number(("door", "hall", "kitchen")) is None
    assert len(task.operators_of(PLAN[0])) == 1


def test_states_are_made_of_atoms(task):
    for state in task.execute(PLAN).states:
        assert task.state_of(task.atoms(state)) == state
        assert task.state_of({*task.atoms(state), ("door", "hall", "kitchen")}) == state
    with pytest.raises(UsageError, match="never true"):
        task.state_of([("locked", "hall")])
    with pytest.raises(UsageError, match="exclude each other"):
        task.state_of([("at", "r1", "hall"), ("at", "r1", "cellar")])


def test_other_goals_share_the_core(task):
    other = task.with_goal([("at", "r1", "kitchen"), ("door", "hall", "kitchen")])
    assert other.core is task.core
    assert other.is_goal(other.execute(PLAN[:1]).states[-1])
    assert not task.with_goal([("locked", "hall")]).goal_reachable


def test_arrays_agree_with_look_ups(task):
    offsets, values = task.core.array("preconditions.offsets"), task.core.array("preconditions.values")
    assert [list(values[offsets[o] : offsets[o + 1]]) for o in range(task.num_operators)] == [
        task.core.preconditions(o) for o in range(task.num_operators)
    ]
    with pytest.raises(ValueError, match="no such array"):
        task.core.array("nothing")


def test_foreign_numbers_are_refused_at_the_door(task):
    with pytest.raises(ValueError, match="not a state"):
        task.is_goal(b"short")
    with pytest.raises(ValueError, match="not a state"):
        task.applicable(b"\xff" * 8 * task.core.num_words)
    for call in (task.action, task.cost, lambda o: task.successor(task.initial_state, o)):
        for number in (-1, task.num_operators):
            with pytest.raises(IndexError):
                call(number)
    with pytest.raises(IndexError):
        task.fact(task.num_facts)


def random_arrays(rng):
    """A random propositional task as `Task.from_arrays` takes it, with conditional effects."""
    num_variables = rng.randint(1, 30)
    variables = [list(range(3 * v, 3 * v + rng.choice([1, 2, 3]))) for v in range(num_variables)]
    renumbered, facts = [], 0
    for variable in variables:
        renumbered.append(list(range(facts, facts + len(variable))))
        facts += len(variable)
    variable_of = [v for v, row in enumerate(renumbered) for _ in row]

    def pick(most):
        chosen = {}
        for fact in rng.sample(range(facts), min(most, facts)):
            chosen.setdefault(variable_of[fact], fact)
        return sorted(chosen.values())

    rows = range(rng.randint(0, 6))
    return {
        "variable_facts": renumbered,
        "preconditions": [pick(rng.randint(0, 2)) for _ in rows],
        "adds": [pick(rng.randint(0, 2)) for _ in rows],
        "deletes": [pick(rng.randint(0, 3)) for _ in rows],
        "costs": [rng.randint(0, 5) for _ in rows],
        "effects": [[(pick(1), pick(1), pick(2)) for _ in range(rng.randint(0, 2))] for _ in rows],
        "initial": pick(num_variables),
        "goal": pick(2),
    }


@settings(max_examples=100)
@given(st.randoms(use_true_random=True))
def test_packed_states_follow_the_operators(rng):
    arrays = random_arrays(rng)
    core = _core.Task.from_arrays(**arrays)
    group_of = {fact: set(row) for row in arrays["variable_facts"] for fact in row}
    true = set(arrays["initial"])
    state = core.pack(sorted(true))
    for _ in range(10):
        assert core.true_facts(state) == sorted(true)
        possible = [o for o, row in enumerate(arrays["preconditions"]) if true.issuperset(row)]
        assert core.applicable(state) == possible
        if not possible:
            break
        operator = rng.choice(possible)
        fired = [([], arrays["adds"][operator], arrays["deletes"][operator])]
        fired += [e for e in arrays["effects"][operator] if true.issuperset(e[0])]
        for _, _, deletes in fired:
            true -= set(deletes)
        for _, adds, _ in fired:
            for fact in adds:  # a variable has one value at a time
                true = (true - group_of[fact]) | {fact}
        state = core.successor(state, operator)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"goal": [99]}, "out of range"),
        ({"initial": [0, 0]}, "twice"),
        ({"costs": [-1]}, "negative"),
        ({"adds": []}, "one row an operator"),
        ({"adds": [[0, 1]]}, "two facts of one variable"),
        ({"variable_facts": [[0], [0, 1, 2]]}, "one variable"),
    ],
)
def test_malformed_arrays_are_refused(change, message):
    arrays = {
        "variable_facts": [[0, 1], [2]],
        "preconditions": [[0]],
        "adds": [[1]],
        "deletes": [[0]],
        "costs": [1],
        "effects": [],
        "initial": [0],
        "goal": [1],
    }
    _core.Task.from_arrays(**arrays)
    with pytest.raises(ValueError, match=message):
        _core.Task.from_arrays(**{**arrays, **change})


def test_a_process_may_end_while_a_thread_holds_a_task():
    program = """
import threading
from explicable.model.grounding import ground
from explicable.pddl import parse_domain, parse_problem

domain = parse_domain("(define (domain lamp) (:predicates (on)) (:action press :effect (on)))")
task = ground(parse_problem("(define (problem p) (:domain lamp) (:init) (:goal (on)))", domain))
held = threading.Event()

def hold(task):
    held.set()
    threading.Event().wait()

threading.Thread(target=hold, args=(task,), daemon=True).start()
held.wait()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=600, check=True)
    assert done.stderr == b""

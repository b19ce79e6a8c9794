"""The grounder against a slow one, on random problems and along random walks."""

import signal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable.errors import ResourceError, UsageError
from explicable.model.grounding import ground, ground_team
from explicable.model.problem import (
    TRUE,
    ActionSchema,
    And,
    Atom,
    Domain,
    Effect,
    Exists,
    Not,
    Or,
    Parameter,
    Predicate,
    Problem,
)
from explicable.model.team import TeamProblem
from oracles import grounding as oracle
from oracles.random_problems import ProblemMaker

GENERATORS = st.randoms(use_true_random=True)
WALK_LENGTH = 12


def check_state(problem, task, state, atoms):
    """The two agree on every atom, on the goal, and on what can be done; returns what can be done."""
    for atom in {*oracle.all_atoms(problem), *atoms}:
        assert task.holds(atom, state) == (atom in atoms), atom
    assert task.state_of(atoms) == state
    assert task.is_goal(state) == oracle.holds(problem, problem.goal, {}, atoms)
    possible = oracle.applicable(problem, atoms)
    actions = {task.action(operator) for operator in task.applicable(state)} - {()}
    assert actions <= possible.keys()
    for action in possible.keys() - actions:  # only what changes nothing may be left out
        assert oracle.successor(problem, *possible[action], atoms) == atoms
    return {action: possible[action] for action in sorted(actions)}


@settings(max_examples=300)
@given(GENERATORS)
def test_task_behaves_as_the_problem_says(rng):
    problem = ProblemMaker(rng).problem()
    task = ground(problem)
    state, atoms = task.initial_state, set(problem.init)
    for _ in range(WALK_LENGTH):
        possible = check_state(problem, task, state, atoms)
        if not possible:
            break
        after = {}
        for action, (schema, binding) in possible.items():
            operators = [o for o in task.operators_of(action) if task.is_applicable(state, o)]
            assert {task.cost(o) for o in operators} == {oracle.cost(problem, schema, binding)}
            after[action] = {task.successor(state, o) for o in operators}
            assert len(after[action]) == 1
        action = rng.choice(list(possible))
        atoms = oracle.successor(problem, *possible[action], atoms)
        state = after[action].pop()


@settings(max_examples=200)
@given(GENERATORS)
def test_operators_are_those_of_the_relaxed_fixpoint(rng):
    problem = ProblemMaker(rng, strips=True).problem()
    task = ground(problem)
    atoms, actions = oracle.relaxed_reachable(problem)
    assert task.goal_reachable == oracle.holds(problem, problem.goal, {}, atoms)
    changing = {
        action
        for action, (schema, binding) in actions.items()
        if any(
            effect.positive or oracle.substitute(effect.atom, binding) in atoms for effect in schema.effects
        )
    }
    operators = range(task.num_operators)
    assert [task.action(o) for o in operators] == list(dict.fromkeys(task.action(o) for o in operators))
    assert {task.action(o) for o in operators} == changing
    facts = {task.fact(fact) for fact in range(task.num_facts)}
    assert facts <= atoms
    assert atoms - facts <= set(problem.init)


@settings(max_examples=100)
@given(GENERATORS)
def test_facts_of_a_variable_exclude_each_other(rng):
    task = ground(ProblemMaker(rng).problem())
    core, state = task.core, task.initial_state
    for _ in range(WALK_LENGTH):
        operators = task.applicable(state)
        if not operators:
            break
        operator = rng.choice(operators)
        true = set(core.true_facts(state))
        fired = [e for e in core.effects(operator) if true.issuperset(e[0])]
        deleted = {*core.deletes(operator), *(fact for effect in fired for fact in effect[2])}
        added = {*core.adds(operator), *(fact for effect in fired for fact in effect[1])}
        state = task.successor(state, operator)
        # A second fact of a variable would have pushed the first one out.
        assert set(core.true_facts(state)) == (true - deleted) | added


def a_disjunction_of(number, kind=Or):
    return kind(tuple(Atom(f"f{i}", ()) for i in range(number)))


def problem_of(precondition, num_predicates, *, goal=TRUE, init=()):
    predicates = tuple(Predicate(f"f{i}", ()) for i in range(num_predicates))
    done = Predicate("done", ())
    act = ActionSchema("act", (), precondition, (Effect(Atom("done", ())),))
    prepare = ActionSchema("prepare", (), And(), tuple(Effect(Atom(p.name, ())) for p in predicates))
    domain = Domain("d", frozenset(), {}, {}, (*predicates, done), (), (act, prepare))
    return Problem("p", domain, {}, init, goal, {})


def test_disjunction_becomes_operators_of_one_action():
    task = ground(problem_of(a_disjunction_of(3), 3))
    assert len(task.operators_of(("act",))) == 3


def test_exponential_normal_form_is_refused():
    clauses = And(tuple(Or((Atom(f"f{2 * i}", ()), Atom(f"f{2 * i + 1}", ()))) for i in range(40)))
    with pytest.raises(ResourceError, match="conjunctions"):
        ground(problem_of(clauses, 80))


def test_quantifiers_in_each_other_do_not_hang():
    condition = Atom("never", ())
    for number in range(40):
        condition = Exists((Parameter(f"?x{number}"),), condition)
    domain = Domain("d", frozenset(), {}, {}, (Predicate("never", ()),), (), ())
    objects = {"a": ("object",), "b": ("object",)}
    with pytest.raises(ResourceError, match="once its quantifiers are expanded"):
        ground(Problem("p", domain, objects, (), condition, {}))


def test_disjunctive_goal_holds_without_auxiliary_steps():
    task = ground(problem_of(And(), 2, goal=Or((Atom("done", ()), Atom("f1", ())))))
    assert not task.is_goal(task.initial_state)
    assert task.is_goal(task.execute([("act",)]).states[-1])
    auxiliary = [o for o in range(task.num_operators) if task.action(o) == ()]
    assert [task.cost(o) for o in auxiliary] == [0, 0]


def test_complement_is_right_where_an_action_adds_and_deletes_under_conditions():
    """``q`` is deleted, and added back if ``f0``: its negation must not become true then."""
    q, f0, done = Atom("q", ()), Atom("f0", ()), Atom("done", ())
    flip = ActionSchema("flip", (), And(), (Effect(q, False), Effect(q, True, f0)))
    finish = ActionSchema("finish", (), Not(q), (Effect(done),))
    switch = ActionSchema("switch", (), And(), (Effect(f0, False),))
    predicates = tuple(Predicate(name, ()) for name in ("q", "f0", "done"))
    domain = Domain("d", frozenset(), {}, {}, predicates, (), (flip, finish, switch))
    task = ground(Problem("p", domain, {}, (("q",), ("f0",)), done, {}))
    kept = task.execute([("flip",)]).states[-1]
    assert task.holds(("q",), kept)
    assert not any(task.is_applicable(kept, o) for o in task.operators_of(("finish",)))
    task.execute([("switch",), ("flip",), ("finish",)])


def test_memory_limit_is_an_error_and_not_the_end():
    parameters = tuple(Parameter(f"?x{i}") for i in range(5))
    act = ActionSchema("act", parameters, And(), (Effect(Atom("f", tuple(p.name for p in parameters))),))
    domain = Domain("d", frozenset(), {}, {}, (Predicate("f", parameters),), (), (act,))
    objects = {f"o{i}": ("object",) for i in range(60)}
    with pytest.raises(ResourceError, match="allowed 64 MiB"):
        ground(Problem("p", domain, objects, (), And(), {}), memory_limit_bytes=64 << 20)


def test_undeclared_names_are_the_callers_mistake():
    with pytest.raises(UsageError, match="'nothing'"):
        ground(problem_of(Atom("nothing", ()), 1))


def test_team_without_human_problem_shares_its_task():
    team = ground_team(TeamProblem(problem_of(And(), 1)))
    assert team.mental is team.task


class AlarmError(Exception):
    """Raised by the signal handler below."""


def test_grounding_can_be_interrupted():
    """Signals are looked at now and then: this task would take minutes."""

    def ring(*_):
        raise AlarmError

    parameters = tuple(Parameter(f"?x{i}") for i in range(8))
    act = ActionSchema("act", parameters, TRUE, (Effect(Atom("f", ("?x0",))),))
    domain = Domain("d", frozenset(), {}, {}, (Predicate("f", parameters[:1]),), (), (act,))
    objects = {f"o{i}": ("object",) for i in range(40)}

    def ground_until_the_alarm():
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        ground(Problem("p", domain, objects, (), TRUE, {}))

    before = signal.signal(signal.SIGALRM, ring)
    try:
        with pytest.raises(AlarmError):
            ground_until_the_alarm()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)

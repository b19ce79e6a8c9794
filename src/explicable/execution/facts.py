"""What a robot finds to be otherwise than its model said, and the model after that."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace

from explicable.errors import UsageError
from explicable.execution.robots.protocol import Fact
from explicable.execution.stage import Stage
from explicable.model.problem import And, Atom, Formula, GroundAtom, Or, Parameter, Predicate, Problem
from explicable.model.task import State, Task
from explicable.model.team import TeamProblem, agent_kind, schema_kind

# No PDDL name has a space in it, so this meets no other.
_IN_SERVICE = Atom("in service", ())


def observable_facts(problem: TeamProblem) -> tuple[GroundAtom, ...]:
    """List the initial facts that robots' steps need and that no step takes away.

    Only from outside can these break: a way is blocked, a thing is not where it should be. A game that is
    prepared for them can go on when they do.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> observable_facts(encode(World(("@*",))))[:2]
    (('adjacent', 'c-0-0', 'c-0-1'), ('adjacent', 'c-0-1', 'c-0-0'))
    """
    domain = problem.composite.domain
    robots = [schema for schema in domain.actions if schema_kind(domain, schema) == "robot"]
    needed = {atom.predicate for schema in robots for atom in _atoms_of(schema.precondition)}
    deleted = {e.atom.predicate for schema in domain.actions for e in schema.effects if not e.positive}
    return tuple(sorted(atom for atom in set(problem.composite.init) if atom[0] in needed - deleted))


def _atoms_of(formula: Formula) -> Iterator[Atom]:
    """Yield the atoms that a formula asks to be true."""
    if isinstance(formula, Atom):
        yield formula
    elif isinstance(formula, And | Or):
        for part in formula.parts:
            yield from _atoms_of(part)


def most_specific(stage: Stage, action: GroundAtom) -> Fact | None:
    """Return the fact that a step which fails again and again speaks for.

    Of what the step needs and what can turn out to be otherwise, it is what shares most objects with the
    step: for a move from a to b, that there is no way from a to b.
    """
    needs = {need for operator in stage.task.operators_of(action) for need in stage.needs(operator)}
    found = max(sorted(needs), key=lambda need: len({*need[0][1:]} & {*action[1:]}), default=None)
    return Fact(found[0], not found[1]) if found else None


def change_state(stage: Stage, state: State, facts: Iterable[Fact]) -> State:
    """Return the state in which some facts are as they were found.

    What becomes true takes the place of what can't be true beside it.

    Raises
    ------
    UsageError
        If the task knows no such fact, or no state in which they hold together.
    """
    task = stage.task
    fluents: dict[GroundAtom, bool] = {}
    for fact in facts:
        if fact.atom in stage.beliefs:
            state = stage.believe(state, fact.atom, true=fact.true)
        elif task.fact_number(fact.atom) is not None:
            fluents[fact.atom] = fact.true
        elif fact.true != task.holds(fact.atom, state):
            raise UsageError(f"this game has no state in which {fact} holds")
    if not fluents:
        return state
    values = {_variable(task, atom): atom for atom in task.atoms(state) if fluents.get(atom, True)}
    values.update((_variable(task, atom), atom) for atom, true in fluents.items() if true)
    changed = task.state_of(values.values())
    if any(task.holds(atom, changed) != true for atom, true in fluents.items()):
        raise UsageError("the facts exclude each other")
    return changed


def _variable(task: Task, atom: GroundAtom) -> int:
    fact = task.fact_number(atom)
    return -1 if fact is None else task.core.fact_variable(fact)


def correct_model(problem: TeamProblem, facts: Iterable[Fact]) -> TeamProblem:
    """Return the team problem in which the robot's initial facts are as found, the person's as they were.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> blocked = Fact(("clear", "c-0-1"), true=False)
    >>> problem = correct_model(encode(World(("@.*",))), [blocked])
    >>> [("clear", "c-0-1") in part.init for part in (problem.robot, problem.mental)]
    [False, True]
    """
    init = dict.fromkeys(problem.robot.init)
    for fact in facts:
        init.pop(fact.atom, None)
        if fact.true:
            init[fact.atom] = None
    return TeamProblem(replace(problem.robot, init=tuple(init)), problem.mental)


def restart_at(problem: TeamProblem, truth: Stage, now: State, belief: Stage, believed: State) -> TeamProblem:
    """Return the team problem that begins now, in the present state and with the present beliefs."""
    robot = replace(problem.robot, init=problem.composite.init)
    return TeamProblem(_begin_at(robot, truth, now), _begin_at(problem.mental, belief, believed))


def _begin_at(problem: Problem, stage: Stage, state: State) -> Problem:
    known = {predicate.name for predicate in problem.domain.predicates}
    constant = [atom for atom in problem.init if stage.task.fact_number(atom) is None]
    changing = sorted(stage.task.atoms(state))
    return replace(problem, init=tuple(atom for atom in (*constant, *changing) if atom[0] in known))


def without(problem: TeamProblem, lost: Collection[str]) -> TeamProblem:
    """Return the team problem in which some agents can do nothing any more, as everybody knows.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> from explicable.model.grounding import ground
    >>> problem = without(encode(World(("@*@",))), ["r1"])
    >>> task = ground(problem.composite)
    >>> {task.action(operator)[1] for operator in range(task.num_operators)} == {"person", "r2"}
    True
    """
    if not lost:
        return problem
    human = None if problem.human is None else _without(problem.human, problem, lost)
    return TeamProblem(_without(problem.robot, problem, lost), human)


def _without(problem: Problem, team: TeamProblem, lost: Collection[str]) -> Problem:
    domain = problem.domain
    schemas = []
    for schema in domain.actions:
        is_agents = schema.parameters and agent_kind(domain, schema.parameters[0].types) is not None
        if is_agents:
            serves = Atom(_IN_SERVICE.predicate, (schema.parameters[0].name,))
            schemas.append(replace(schema, precondition=And((serves, schema.precondition))))
        elif team.agent_of((schema.name,)).name not in lost:
            schemas.append(schema)
    known = {**domain.constants, **problem.objects}
    left = [agent.name for agent in team.agents if agent.name in known and agent.name not in lost]
    parameter = Parameter("?agent", ("object",))
    predicate = Predicate(_IN_SERVICE.predicate, (parameter,))
    return replace(
        problem,
        domain=replace(domain, predicates=(*domain.predicates, predicate), actions=tuple(schemas)),
        init=(*problem.init, *((_IN_SERVICE.predicate, name) for name in left)),
    )

"""Grounding: from a lifted problem to a task whose operators and facts are numbered.

The compiled core joins the preconditions over static atoms and relaxed reachability (`cpp/grounding`). Only
operators and facts that the delete relaxation reaches are kept, as in Helmert, "Concise finite-domain
representations for PDDL planning tasks" (Artificial Intelligence 173, 2009). Quantifiers are expanded,
negation is compiled into complementary facts where a condition asks for it, and a disjunction in a
precondition becomes several operators with the same action.
"""

from explicable import _core
from explicable.errors import ResourceError, UsageError
from explicable.model.encoding import encode
from explicable.model.memory import available_memory_bytes
from explicable.model.problem import Problem
from explicable.model.task import Task
from explicable.model.team import TeamProblem, TeamTask


def ground(problem: Problem, *, memory_limit_bytes: int | None = None) -> Task:
    """Ground a problem.

    Parameters
    ----------
    problem
        A lifted problem, as the PDDL parser returns it.
    memory_limit_bytes
        How much the grounder may allocate, in bytes; by default four fifths of what is free.

    Raises
    ------
    ResourceError
        If the task needs more memory, or a condition splits into too many conjunctions.
    UsageError
        If the problem names something that it does not declare.

    Examples
    --------
    >>> from explicable.model.problem import And, Atom, ActionSchema, Domain, Effect, Predicate, Problem
    >>> lit = Atom("lit", ())
    >>> light = ActionSchema("light", (), And(), (Effect(lit),))
    >>> domain = Domain("lamp", frozenset(), {}, {}, (Predicate("lit", ()),), (), (light,))
    >>> task = ground(Problem("dark", domain, {}, (), lit, {}))
    >>> [task.action(operator) for operator in task.applicable(task.initial_state)]
    [('light',)]
    """
    encoded = encode(problem)
    limit = usual_memory_limit_bytes() if memory_limit_bytes is None else memory_limit_bytes
    try:
        core = _core.ground(
            encoded.structure,
            encoded.initial,
            encoded.num_initial,
            encoded.function_arguments,
            encoded.function_values,
            max(0, limit),
        )
    except MemoryError as error:
        why = "there is not enough memory for grounding" if str(error) == "std::bad_alloc" else error
        raise ResourceError(f"problem {problem.name}: {why}") from error
    except ValueError as error:
        raise UsageError(f"problem {problem.name}: {error}") from error
    return Task(problem, core, encoded.objects, tuple(core.goal), core.goal_reachable)


def usual_memory_limit_bytes() -> int:
    """Return what a grounder may allocate by default, in bytes: four fifths of what is free.

    Examples
    --------
    >>> usual_memory_limit_bytes() > 0
    True
    """
    return available_memory_bytes() * 4 // 5


def ground_team(problem: TeamProblem, *, memory_limit_bytes: int | None = None) -> TeamTask:
    """Ground a team problem: the composite task, and the mental task where it is another one.

    The memory limit holds for each of the two; see `ground`.

    Raises
    ------
    PDDLError
        If the two models contradict each other.
    ResourceError
        As `ground`.
    """
    if memory_limit_bytes is None:
        memory_limit_bytes = usual_memory_limit_bytes()
    task = ground(problem.composite, memory_limit_bytes=memory_limit_bytes)
    if problem.human is None:
        return TeamTask(problem, task, task)
    return TeamTask(problem, task, ground(problem.mental, memory_limit_bytes=memory_limit_bytes))

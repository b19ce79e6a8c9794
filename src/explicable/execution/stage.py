"""The task on which a game is played, with two switches that planning tasks do not have.

Beliefs come and go during play, and sometimes the question is what the robots can do alone. Neither needs a
new grounding: the problem gets two extra facts, and

- every fact on which truth and belief differ gets two operators, *believe* and *doubt*, so that it counts as
  a fluent and a belief is just a state;
- human schemas need the fact that humans act;
- *settle* operators end all believing, with the humans or without them, and thereby make a state to search
  from.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from explicable.model.grounding import ground
from explicable.model.problem import ActionSchema, And, Atom, Effect, GroundAtom, Predicate, Problem
from explicable.model.task import State, Task
from explicable.model.team import TeamProblem, schema_kind

# No PDDL name has a space in it, so these meet no others.
_OPEN = Atom("open to belief", ())
_HUMANS = Atom("humans act", ())
_SETTLE = "settle with humans"
_SETTLE_ALONE = "settle without humans"


@dataclass(frozen=True, slots=True)
class Stage:
    """A grounded task whose states can be edited by belief; made by `build_stage`.

    Parameters
    ----------
    task
        The grounded task, extra facts and operators included.
    beliefs
        The facts that can be flipped, each with its operators (believe, doubt).
    settle, settle_alone
        The operators that lead from any state to the one to search from, where the whole team acts, or robots
        alone.
    """

    task: Task
    beliefs: dict[GroundAtom, tuple[int, int]]
    settle: int
    settle_alone: int

    def believe(self, state: State, atom: GroundAtom, *, true: bool) -> State:
        """Return the state with one of the facts in ``beliefs`` made true or false."""
        believe, doubt = self.beliefs[atom]
        return self.task.successor(state, believe if true else doubt)

    def needs(self, operator: int) -> tuple[tuple[GroundAtom, bool], ...]:
        """List which of the facts in ``beliefs`` an operator needs, with the truth values that it needs."""
        needs = []
        for fact in self.task.core.preconditions(operator):
            atom = self.task.fact(fact)
            true = atom[0] != "not"
            if (atom if true else atom[1:]) in self.beliefs:
                needs.append((atom if true else atom[1:], true))
        return tuple(needs)


def differences(problem: TeamProblem) -> tuple[GroundAtom, ...]:
    """List the initial facts on which truth and belief differ, as far as the person's model has words.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> differences(encode(World(("@x*", "..o"))))
    (('clear', 'c-0-1'),)
    """
    differing = set(problem.composite.init) ^ set(problem.mental.init)
    return tuple(sorted(sayable(problem.mental, differing)))


def sayable(problem: Problem, atoms: Iterable[GroundAtom]) -> list[GroundAtom]:
    """Keep the atoms whose predicate and objects a problem declares."""
    objects = {*problem.objects, *problem.domain.constants}
    predicates = {predicate.name for predicate in problem.domain.predicates}
    return [atom for atom in atoms if atom[0] in predicates and objects.issuperset(atom[1:])]


def build_stage(
    problem: Problem, flippable: Iterable[GroundAtom] = (), *, memory_limit_bytes: int | None = None
) -> Stage:
    """Ground a problem with the two switches.

    Parameters
    ----------
    problem
        Any problem; the schemas of humans are told by their first parameter.
    flippable
        Atoms whose truth value can be edited in states.
    memory_limit_bytes
        As of `explicable.model.grounding.ground`.
    """
    flippable = tuple(flippable)
    task = ground(_switched(problem, flippable), memory_limit_bytes=memory_limit_bytes)

    def switch(name: str) -> int:
        (operator,) = task.operators_of((name,))
        return operator

    beliefs = {
        atom: (switch(_flip_name(number, true=True)), switch(_flip_name(number, true=False)))
        for number, atom in enumerate(flippable)
    }
    return Stage(task, beliefs, switch(_SETTLE), switch(_SETTLE_ALONE))


def _flip_name(number: int, *, true: bool) -> str:
    return f"{'believe' if true else 'doubt'} {number}"


def _switched(problem: Problem, flippable: tuple[GroundAtom, ...]) -> Problem:
    domain = problem.domain
    switches = [
        ActionSchema(
            _flip_name(number, true=true), (), _OPEN, (Effect(Atom(atom[0], atom[1:]), positive=true),)
        )
        for number, atom in enumerate(flippable)
        for true in (True, False)
    ]
    switches.append(ActionSchema(_SETTLE, (), _OPEN, (Effect(_OPEN, positive=False),)))
    alone = (Effect(_OPEN, positive=False), Effect(_HUMANS, positive=False))
    switches.append(ActionSchema(_SETTLE_ALONE, (), And((_OPEN, _HUMANS)), alone))
    actions = [
        replace(schema, precondition=And((_HUMANS, schema.precondition)))
        if schema_kind(domain, schema) == "human"
        else schema
        for schema in domain.actions
    ]
    return replace(
        problem,
        domain=replace(
            domain,
            predicates=(*domain.predicates, Predicate(_OPEN.predicate, ()), Predicate(_HUMANS.predicate, ())),
            actions=(*actions, *switches),
        ),
        init=(*problem.init, (_OPEN.predicate,), (_HUMANS.predicate,)),
    )

"""A team problem made ready for play: the truth, the beliefs, and what differs between them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar, cast

from explicable.execution.outlook import Outlook
from explicable.execution.stage import build_stage, differences, sayable
from explicable.model.grounding import ground, usual_memory_limit_bytes
from explicable.model.problem import GroundAtom, Problem
from explicable.model.task import Task
from explicable.model.team import TeamProblem

Shared = TypeVar("Shared")


@dataclass(frozen=True)
class Setting:
    """Where games of one team problem are played; keep it, since what was found out in a game is remembered.

    Parameters
    ----------
    problem
        The team problem.
    truth
        The composite task: what really happens.
    belief
        The mental task: what a participant thinks happens.
    differing
        Initial facts on which the two differ: what there is to learn.
    same_schemas
        Whether every step has the same effects in both, so that watching it teaches nothing else.
    """

    problem: TeamProblem
    truth: Outlook
    belief: Outlook
    differing: tuple[GroundAtom, ...]
    same_schemas: bool

    def shared(self, kind: Callable[["Setting"], Shared]) -> Shared:
        """Return what is made of a setting once, for all who play there.

        Examples
        --------
        >>> from explicable.execution.thoughts import Thoughts
        >>> from explicable.first_response import World, encode
        >>> setting = prepare(encode(World(("*@*",))))
        >>> setting.shared(Thoughts) is setting.shared(Thoughts)
        True
        """
        if kind not in self._made:
            self._made[kind] = kind(self)
        return cast("Shared", self._made[kind])

    @cached_property
    def _made(self) -> dict[object, object]:
        return {}


def prepare(problem: TeamProblem, observable: Iterable[GroundAtom] = ()) -> Setting:
    """Ground a team problem for play.

    Parameters
    ----------
    problem
        The team problem.
    observable
        Facts that may turn out to be otherwise during play, such as those of
        `explicable.execution.observable_facts`. Each makes the tasks a little larger.

    Raises
    ------
    PDDLError
        If the two models contradict each other.
    """
    differing = differences(problem)
    observable = tuple(observable)
    composite, mental = problem.composite, problem.mental
    same_schemas = set(composite.domain.actions) == set(mental.domain.actions)
    limit = usual_memory_limit_bytes()

    def look_at(model: Problem, flippable: Iterable[GroundAtom]) -> Outlook:
        return Outlook(problem, build_stage(model, dict.fromkeys(flippable), memory_limit_bytes=limit))

    truth = look_at(composite, (*differing, *observable))
    surprising = () if same_schemas else _surprising(truth.task, mental)
    belief = look_at(mental, (*differing, *surprising, *sayable(mental, observable)))
    return Setting(problem, truth, belief, differing, same_schemas)


def _surprising(truth: Task, mental: Problem) -> tuple[GroundAtom, ...]:
    """List the facts that really change, and that the person has words for but takes to be constant."""
    believed = ground(mental)
    changing = (truth.fact(fact) for fact in range(truth.num_facts))
    return tuple(atom for atom in sayable(mental, changing) if believed.fact_number(atom) is None)

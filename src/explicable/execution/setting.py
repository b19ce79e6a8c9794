"""A team problem made ready for play: the truth, the beliefs, and what differs between them."""

from dataclasses import dataclass

from explicable.execution.outlook import Outlook
from explicable.execution.stage import build_stage, differences
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem


@dataclass(frozen=True, slots=True)
class Setting:
    """Where games of one team problem are played; keep it, since what its outlooks found out is remembered.

    Parameters
    ----------
    problem
        The team problem.
    truth
        The composite task: what really happens.
    belief
        The mental task: what a participant thinks happens.
    differing
        Initial facts on which the two differ; only these can be learnt.
    same_schemas
        Whether every step has the same effects in both, so that watching it teaches nothing else.
    """

    problem: TeamProblem
    truth: Outlook
    belief: Outlook
    differing: tuple[GroundAtom, ...]
    same_schemas: bool


def prepare(problem: TeamProblem) -> Setting:
    """Ground a team problem for play.

    Raises
    ------
    PDDLError
        If the two models contradict each other.
    """
    differing = differences(problem)
    composite, mental = problem.composite, problem.mental
    return Setting(
        problem=problem,
        truth=Outlook(problem, build_stage(composite, differing)),
        belief=Outlook(problem, build_stage(mental, differing)),
        differing=differing,
        same_schemas=set(composite.domain.actions) == set(mental.domain.actions),
    )

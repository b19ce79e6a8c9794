"""Tellings: steps of a plan by which a robot tells the people of one difference between the two models.

In plan files a telling is a line among the others, ``(tell r1 clear c-1-2 does not hold)``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from explicable.errors import PlanError
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom
from explicable.model.team import TeamProblem, TeamTask
from explicable.planning.differences import Difference, find_differences
from explicable.planning.explanation import tell

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller
    from explicable.labelling.features import TeamFeatures

_TELL = "tell"


@dataclass(frozen=True, slots=True)
class Telling:
    """A step of a plan by which a robot tells the person of one difference between the two models.

    Attributes
    ----------
    before_step
        It comes right before this step of the plan, counted from 0 without the tellings.
    agent
        The robot that tells: the one that acts next.
    difference
        What it tells.
    """

    before_step: int
    agent: str
    difference: Difference

    @property
    def action(self) -> GroundAtom:
        """What a plan's line says, as names."""
        return (_TELL, self.agent, *_words(self.difference))

    def __str__(self) -> str:
        return format_action(self.action)


def telling_schema(problem: TeamProblem) -> str | None:
    """Return how a plan's lines begin that tell something; None where a domain means its own by that.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> telling_schema(encode(World(("@*",))))
    'tell'
    """
    models = (problem.robot, problem.mental)
    is_own = any(schema.name == _TELL for model in models for schema in model.domain.actions)
    return None if is_own else _TELL


def part_tellings(
    problem: TeamProblem, lines: Sequence[GroundAtom]
) -> tuple[tuple[GroundAtom, ...], tuple[Telling, ...]]:
    """Part what a plan's lines do from what they tell.

    Raises
    ------
    PlanError
        With the number of the line's step, if one tells of no difference between the two models, or who tells
        is no robot of the team, or the team has no humans.

    Examples
    --------
    >>> from explicable.first_response import World, encode
    >>> team = encode(World(("@x*", "...")))
    >>> tell = ("tell", "r1", "clear", "c-0-1", "does", "not", "hold")
    >>> actions, (telling,) = part_tellings(team, [("command", "person", "c-0-2"), tell])
    >>> print(actions, telling.before_step, telling.difference)
    (('command', 'person', 'c-0-2'),) 1 (clear c-0-1) does not hold
    """
    telling = telling_schema(problem)
    if all(line[0] != telling for line in lines):
        return tuple(lines), ()
    differences = {_words(difference): difference for difference in find_differences(problem)}
    kinds = {agent.name: agent.kind for agent in problem.agents}
    actions: list[GroundAtom] = []
    tellings: list[Telling] = []
    for number, line in enumerate(lines, start=1):
        if line[0] != telling:
            actions.append(line)
            continue
        teller, words = "".join(line[1:2]), line[2:]
        if kinds.get(teller) != "robot":
            raise PlanError(f"{teller or 'nobody'} is no robot that could tell anything", step=number)
        if "human" not in kinds.values():
            raise PlanError(f"there is nobody to tell anything: {format_action(line)}", step=number)
        if words not in differences:
            raise PlanError(
                f"{' '.join(words)!r} is no difference between the two models: what is told must be one",
                step=number,
            )
        tellings.append(Telling(len(actions), teller, differences[words]))
    return tuple(actions), tuple(tellings)


def label_told(
    team_task: TeamTask,
    labeller: "Labeller",
    actions: Sequence[GroundAtom],
    told: Sequence[frozenset[Difference]],
) -> "LabelledPlan":
    """Label a plan whose steps are watched by people who have been told something by then.

    Parameters
    ----------
    told
        For each step, all that was told before it.
    """
    features: dict[frozenset[Difference], TeamFeatures] = {frozenset(): labeller.features(team_task)}
    for known in told:
        if known not in features:
            ordered = [one for one in find_differences(team_task.problem) if one in known]
            features[known] = labeller.features(tell(team_task, ordered))
    return labeller.label(features[frozenset()], actions, knowing=[features[known] for known in told])


def _words(difference: Difference) -> tuple[str, ...]:
    """Write a difference as the names of a plan's line."""
    return tuple(str(difference).lower().replace("(", "").replace(")", "").split())

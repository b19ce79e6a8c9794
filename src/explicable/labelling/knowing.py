"""Tasks in which telling the person something is a step, and the labeller that looks on as they learn it.

What has been told is one more variable of the task. The labeller judges each step with the mental model that
the person has by then: there is one compiled scorer for each set of things told, and all agree in everything
but the mental model, so that a path may pass from one to the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from explicable import _core
from explicable.model.problem import TRUE, ActionSchema
from explicable.model.task import Task

if TYPE_CHECKING:
    from explicable.labelling.choices import ChoiceModel
    from explicable.labelling.features import TeamFeatures
    from explicable.labelling.labeller import Labeller

TELL = "tell "
"""Begins the names of telling steps, before the number of what is told; no action of PDDL has such a name."""


@dataclass(frozen=True, slots=True)
class TellingTask:
    """A task whose plans may tell.

    Attributes
    ----------
    task
        The composite task with one more step, ``("tell k",)``, for each thing that can be told. It costs
        nothing: the scorer charges for it.
    scorer
        For searches of this task only.
    """

    task: Task
    scorer: _core.PathScorer


def telling_task(
    labeller: "Labeller",
    knowing: "dict[frozenset[int], TeamFeatures]",
    price: float,
    *,
    choice_model: "ChoiceModel | None" = None,
    charge: float = 0.0,
) -> TellingTask:
    """Compile a labeller for plans that may tell.

    Parameters
    ----------
    knowing
        For each set of things told, by number, the team task as the person then sees it; the composite task
        is the same in all. The empty set must be there, and telling leads only to sets that are.
    price
        Of telling one thing, in the unit of cost.
    choice_model, charge
        As in `Labeller.scorer`.
    """
    sets = tuple(sorted(knowing, key=lambda told: (len(told), sorted(told))))
    numbers = {told: number for number, told in enumerate(sets)}
    task = knowing[frozenset()].task
    domain = task.problem.domain
    things = sorted(frozenset().union(*sets))
    schemas = tuple(ActionSchema(f"{TELL}{thing}", (), TRUE, ()) for thing in things)
    tellings = [
        (numbers[told], numbers[more], len(domain.actions) + place)
        for told in sets
        for place, thing in enumerate(things)
        if thing not in told and (more := told | {thing}) in numbers
    ]
    scorers = [labeller.scorer(knowing[told], choice_model=choice_model, charge=charge) for told in sets]
    problem = replace(task.problem, domain=replace(domain, actions=(*domain.actions, *schemas)))
    core = _core.with_telling(task.core, len(sets), tellings)
    return TellingTask(
        replace(task, problem=problem, core=core),
        _core.TellingScorer(task.core, scorers, price),
    )


def told_by(action: Sequence[str]) -> int | None:
    """Return the number of what a step of a telling task tells; None if it is another step."""
    return int(action[0].removeprefix(TELL)) if action and action[0].startswith(TELL) else None

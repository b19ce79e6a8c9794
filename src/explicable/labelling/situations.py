"""Where a plan leaves the person a choice, and what speaks for each alternative.

Before every step of a plan the person either waits or takes one of the human steps that are possible then.
The features of these alternatives (`HUMAN_FEATURES`) name no object, so that what is learned on one map holds
on every other. How far off something seems is counted in transitions of the variables that fulfilling it asks
for, in the mental model: `cpp/labelling/human_choices.cpp` makes these tables once, and a search looks
them up.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from explicable.labelling.features import MAX_REQUESTS, TeamFeatures
from explicable.model.problem import GroundAtom
from explicable.model.task import State

HUMAN_FEATURES = (
    "waits, nothing open",
    "waits, a request open",
    "asks for nothing",
    "asks for what seems impossible",
    "rank of the distance",
    "asks for the nearest",
    "repeats an open request",
)
"""In the order of the core's `HumanFeature`."""


@dataclass(frozen=True, slots=True)
class Situation:
    """A point of a plan at which the person can act.

    Parameters
    ----------
    number
        Of the step that follows.
    turn
        Features of waiting and of acting.
    options
        Features of the human steps possible.
    step
        Which of them follows; None if the person waits.
    """

    number: int
    turn: tuple[Mapping[str, float], Mapping[str, float]]
    options: list[dict[str, float]]
    step: int | None


def situations(features: TeamFeatures, actions: Sequence[GroundAtom]) -> Iterator[Situation]:
    """Yield every situation of a plan in which some human step is possible.

    Raises
    ------
    PlanError
        If a step is not applicable.
    """
    task, tables = features.task, features.tables
    for number, (operator, state, requests) in enumerate(_moments(features, actions)):
        options = features.choices.options(state, requests)
        if operator is not None and options:
            waits = HUMAN_FEATURES[bool(requests)]
            possible = [task.action(option[0]) for option in options]
            step = possible.index(actions[number]) if tables.is_human(operator) else None
            described = [_describe(*option[1:]) for option in options]
            yield Situation(number, ({waits: 1.0}, {}), described, step)


def options_after(
    features: TeamFeatures, actions: Sequence[GroundAtom]
) -> tuple[list[GroundAtom], list[dict[str, float]]]:
    """Return the human steps that are possible when a plan has been carried out, and their features.

    Raises
    ------
    PlanError
        If a step is not applicable.
    """
    *_, (_, state, requests) = _moments(features, actions)
    options = features.choices.options(state, requests)
    return [features.task.action(option[0]) for option in options], [
        _describe(*option[1:]) for option in options
    ]


def _moments(
    features: TeamFeatures, actions: Sequence[GroundAtom]
) -> Iterator[tuple[int | None, State, list[int]]]:
    """Yield each step's operator, the state before it and the requests open then; at the end no operator."""
    tables = features.tables
    execution = features.task.execute(actions)
    requests: list[int] = []  # open ones, the latest last
    for number, operator in enumerate(execution.operators):
        yield operator, execution.states[number], requests
        if tables.is_human(operator):
            if (asked := tables.asks_for(operator)) >= 0:
                requests = [*(r for r in requests if r != asked), asked][-MAX_REQUESTS:]
        else:
            requests = [r for r in requests if r not in tables.fulfils(operator)]
        after = execution.states[number + 1]
        requests = [r for r in requests if features.stands(r, after)]
    yield None, execution.states[-1], requests


def _describe(request: int, has_way: bool, rank: int, repeats: bool) -> dict[str, float]:
    _, _, nothing, impossible, ranked, nearest, again = HUMAN_FEATURES
    features = {again: 1.0} if repeats else {}
    if request < 0:
        return features | {nothing: 1.0}
    if not has_way:
        return features | {impossible: 1.0}
    return features | {ranked: float(rank), nearest: float(rank == 0)}

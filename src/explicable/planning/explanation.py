"""Why this plan: which steps are expected, what speaks against the others, and what would make them expected.

For an unexpected step the smallest set of model differences is looked for after whose telling the labeller
expects the step: a minimally complete explanation in the sense of Chakraborti et al. (IJCAI 2017), with the
labeller in the place of optimality. Telling more may well make a step less expected, so sets are tried in
the order of their size, all of one size before the next.
"""

import itertools
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

from explicable.errors import UsageError
from explicable.model.grounding import ground
from explicable.model.plan import format_action
from explicable.model.problem import GroundAtom
from explicable.model.task import State, Task
from explicable.model.team import TeamTask
from explicable.planning.beliefs import watch
from explicable.planning.correction import correct
from explicable.planning.deadline import Deadline
from explicable.planning.differences import Difference, find_differences
from explicable.search import search

if TYPE_CHECKING:
    from explicable.labelling import LabelledPlan, Labeller
    from explicable.labelling.features import TeamFeatures

_WAY_EVALUATIONS = 10_000  # for a guess at what the person expected; only the order of trials hangs on it


class Finding(StrEnum):
    """What the search for an explanation came to."""

    EXPECTED = "expected"
    """Nothing needs to be told: the step is expected, or a human's."""
    EXPLAINED = "explained"
    """A set was found, and all smaller ones were tried."""
    NONE = "no explanation"
    """All sets up to the size allowed were tried."""
    LIMIT = "limit reached"
    """The time was up."""


@dataclass(frozen=True, slots=True)
class StepExplanation:
    """Why one step.

    Attributes
    ----------
    number
        Of the step, from 1.
    action
        The step.
    probability
        That it is expected.
    reasons
        The features that speak against it, with their weight in log odds, the strongest first; none for an
        expected step.
    finding
        What the search came to.
    told
        The smallest set of differences after whose telling it is expected, if one was found.
    probability_told
        That it is expected then.
    size_tried
        All sets of differences up to this size were tried.
    """

    number: int
    action: GroundAtom
    probability: float
    reasons: tuple[tuple[str, float], ...]
    finding: Finding
    told: tuple[Difference, ...] = ()
    probability_told: float | None = None
    size_tried: int = 0

    def __str__(self) -> str:
        text = f"Step {self.number}, {format_action(self.action)}, is "
        if self.finding is Finding.EXPECTED:
            return f"{text}expected ({self.probability:.2f})."
        text += f"unexpected ({self.probability:.2f})."
        if self.reasons:
            text += f" Against it: {'; '.join(f'{why} ({weight:+.1f})' for why, weight in self.reasons)}."
        if self.finding is Finding.EXPLAINED:
            knowledge = ", and that ".join(map(str, self.told))
            return f"{text} Did the person know that {knowledge}, it would be ({self.probability_told:.2f})."
        if self.finding is Finding.LIMIT:
            return f"{text} The time was up before an explanation was found."
        if self.size_tried == 0:
            return f"{text} There is nothing that the person could be told."
        return (
            f"{text} Nothing that the person could be told, up to {self.size_tried} at a time, explains it."
        )


def explain(
    team_task: "TeamTask | TeamFeatures",
    labeller: "Labeller",
    actions: Sequence[GroundAtom],
    *,
    threshold: float = 0.5,
    max_told: int = 3,
    time_limit_s: float = 10.0,
    num_reasons: int = 3,
) -> tuple[StepExplanation, ...]:
    """Explain a plan step by step.

    Each set of differences corrects the mental problem, which is grounded anew, and the whole plan is
    labelled again; what one step's search finds out serves all others. Differences about the objects of the
    step, or of the way that the person might have expected instead, are tried first among sets of the same
    size; so of several smallest sets, the one that has most to do with the step is likely to be given.

    Parameters
    ----------
    team_task
        The task, or what the labeller sees of it if that was made before (`Labeller.features`).
    actions
        A plan of the composite task, from the initial state.
    threshold
        A step is expected if the probability of its being explicable is at least this.
    max_told
        Largest set that is tried.
    time_limit_s
        Seconds for the whole search.
    num_reasons
        At most so many features for each unexpected step.

    Raises
    ------
    PlanError
        If a step is not applicable.
    UsageError
        If the threshold is not between 0 and 1, or the size is negative.
    LabellerError
        If the labeller was trained on another domain.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> from explicable.labelling.crf import ConditionalRandomField
    >>> from explicable.labelling.labeller import Labeller
    >>> from explicable.model.grounding import ground_team
    >>> weights = ["request: move farther"], [[-5.0, 0.0]], [[0, 0], [0, 0]]
    >>> labeller = Labeller(ConditionalRandomField.from_weights([True, False], *weights), schemas=["move"])
    >>> team_task = ground_team(encode(World(("@x*", "..."))))
    >>> plan = [("command", "person", "c-0-2"), ("move", "r1", "c-0-0", "c-1-0")]
    >>> print(explain(team_task, labeller, plan)[1])
    Step 2, (move r1 c-0-0 c-1-0), is unexpected (0.01). Against it: move, as the person sees the request: \
farther (-5.0). Did the person know that (clear c-0-1) does not hold, it would be (0.50).
    """
    if not 0 <= threshold <= 1 or max_told < 0:
        raise UsageError("the threshold must be between 0 and 1, and the size of a set not negative")
    deadline = Deadline.after(time_limit_s)
    features = labeller.features(team_task)
    labelled = labeller.label(features, actions)
    counsel = _Counsel(features.team, labeller, labelled, deadline)
    most = max(map(len, labelled.features), default=0)
    return tuple(
        _explain_step(counsel, number, threshold, max_told, [r for r in reasons if r[1] < 0][:num_reasons])
        for number, reasons in enumerate(labeller.explain(labelled, most))
    )


class _Counsel:
    """Answers what the labeller would say, had the person been told something; remembers all answers."""

    def __init__(
        self, team_task: TeamTask, labeller: "Labeller", labelled: "LabelledPlan", deadline: Deadline
    ) -> None:
        self.team_task = team_task
        self.labeller = labeller
        self.labelled = labelled
        self.deadline = deadline
        self.differences = find_differences(team_task.problem)
        self._about: defaultdict[str, list[int]] = defaultdict(list)  # numbers of differences, by object
        for number, difference in enumerate(self.differences):
            for name in difference.names:
                self._about[name].append(number)
        self.believed = watch(team_task, labelled.actions).states
        self._answers: dict[frozenset[Difference], tuple[float, ...]] = {}

    def most_relevant_first(self, touched: set[str]) -> list[Difference]:
        """Order differences by how much of what they are about is among some objects and actions."""
        shares: defaultdict[int, float] = defaultdict(float)
        for name in touched:
            for number in self._about.get(name, ()):
                shares[number] += 1.0 / len(self.differences[number].names)
        relevant = sorted(shares, key=lambda number: (-shares[number], number))
        rest = (one for number, one in enumerate(self.differences) if number not in shares)
        return [*(self.differences[number] for number in relevant), *rest]

    def probabilities(self, told: tuple[Difference, ...]) -> tuple[float, ...] | None:
        """Return how probably each step is expected after telling; None if the time is up."""
        key = frozenset(told)
        if key not in self._answers:
            if self.deadline.left_s <= 0:
                return None
            corrected = tell(self.team_task, told)
            self._answers[key] = self.labeller.label(corrected, self.labelled.actions).probabilities
        return self._answers[key]


def tell(team_task: TeamTask, told: Sequence[Difference]) -> TeamTask:
    """Return the team task after the person was told of some differences; only the mental task is new."""
    corrected = correct(team_task.problem, told)
    return TeamTask(corrected, team_task.task, ground(corrected.mental))


def _explain_step(
    counsel: _Counsel,
    number: int,
    threshold: float,
    max_told: int,
    reasons: Sequence[tuple[str, float]],
) -> StepExplanation:
    action, probability = counsel.labelled.actions[number], counsel.labelled.probabilities[number]
    if not counsel.labelled.is_robot[number] or probability >= threshold:
        return StepExplanation(number + 1, action, probability, (), Finding.EXPECTED)
    unexpected = StepExplanation(number + 1, action, probability, tuple(reasons), Finding.NONE)
    ordered = _most_relevant_first(counsel, number)
    for size in range(1, min(max_told, len(ordered)) + 1):
        for told in itertools.combinations(ordered, size):
            answer = counsel.probabilities(told)
            if answer is None:
                return replace(unexpected, finding=Finding.LIMIT)
            if answer[number] >= threshold:
                return replace(
                    unexpected, finding=Finding.EXPLAINED, told=told, probability_told=answer[number]
                )
        unexpected = replace(unexpected, size_tried=size)
    return unexpected


def _most_relevant_first(counsel: _Counsel, number: int) -> list[Difference]:
    """Order differences by how much of what they are about belongs to the step or to the way expected."""
    mental = counsel.team_task.mental
    touched = set(counsel.labelled.actions[number])
    for action in _expected_way(mental, counsel.believed[number], counsel.deadline.left_s):
        touched.update(action)
    return counsel.most_relevant_first(touched)


def _expected_way(mental: Task, state: State, left_s: float) -> Iterator[GroundAtom]:
    """Guess what the person expects from here: any plan of the mental task, if there is time to find one."""
    if left_s <= 0:
        return
    result = search(
        mental, "lazy", initial_state=state, max_evaluations=_WAY_EVALUATIONS, time_limit_s=left_s
    )
    yield from map(mental.action, result.operators or ())

"""From traces to what a conditional random field is trained on: features and labels of steps."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from explicable.errors import PlanError, TraceError, UsageError
from explicable.labelling.augment import ground_symbol_features, interchangeable_objects, permute
from explicable.labelling.augment import random_permutations as draw_permutations
from explicable.labelling.features import TeamFeatures
from explicable.labelling.traces import Trace
from explicable.model.grounding import ground_team

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np

    from explicable.model.problem import GroundAtom
    from explicable.model.task import Execution
    from explicable.model.team import TeamProblem

CLASSES = (True, False)
"""Explicable and inexplicable; ties go to the first, and the second is the paper's empty label."""

Symbols = Literal["lifted", "ground"]
"""Lifted features, which name no object; or the paper's: the ground symbols of a step."""

Rows = list[tuple[str, ...]]
"""Features of each step of a plan; none of human steps, about which nobody is asked."""


def step_features(
    team: TeamFeatures,
    execution: "Execution",
    symbols: Symbols = "lifted",
    knowing: "Sequence[TeamFeatures] | None" = None,
) -> Rows:
    """Return the features of each step of an executed plan; `knowing` as in `TeamFeatures.extract`.

    Examples
    --------
    >>> from explicable.first_response.encoding import encode
    >>> from explicable.first_response.world import World
    >>> team = TeamFeatures(ground_team(encode(World(("@*",)))))
    >>> plan = [("command", "person", "c-0-1"), ("move", "r1", "c-0-0", "c-0-1")]
    >>> step_features(team, team.task.execute(plan), "ground")
    [(), ('move', '1=r1', '2=c-0-0', '3=c-0-1', '(move r1 c-0-0 c-0-1)')]
    """
    if symbols == "lifted":
        return team.extract(execution.operators, execution.states, knowing)
    is_human = [team.tables.is_human(operator) for operator in execution.operators]
    return _symbols([team.task.action(operator) for operator in execution.operators], is_human)


def _symbols(actions: "Sequence[GroundAtom]", is_human: "Sequence[bool]") -> Rows:
    rows = ground_symbol_features(actions)
    return [() if human else tuple(row) for row, human in zip(rows, is_human, strict=True)]


class TrainingData:
    """Features and labels of traces; each problem is grounded once.

    Parameters
    ----------
    symbols
        Which features.
    num_copies
        How many copies of each trace, its objects renamed at random, are trained on beside the trace itself.
        Traces of one problem share their renamings, as in the paper.
    rng
        Source of the renamings; needed for copies.

    Attributes
    ----------
    features, labels, task_labels
        Of each step of each trace. ``labels`` are those of `CLASSES`, or None; ``task_labels`` say in
        addition which task a step serves, where the annotator named it.
    annotators
        Of each trace.
    schemas
        Names of the robots' action schemas that occurred.
    num_labels
        Labelled steps of robots.
    """

    def __init__(
        self,
        symbols: Symbols = "lifted",
        num_copies: int = 0,
        rng: "np.random.Generator | None" = None,
    ) -> None:
        self.symbols: Symbols = symbols
        self.num_copies = num_copies
        self.features: list[Rows] = []
        self.labels: list[list[bool | None]] = []
        self.task_labels: list[list[bool | str | None]] = []
        self.annotators: list[str] = []
        self.schemas: set[str] = set()
        self.num_labels = 0
        self._rng = rng
        self._actions: list[tuple[TeamProblem, tuple[GroundAtom, ...]]] = []
        self._teams: dict[int, tuple[TeamProblem, TeamFeatures]] = {}  # holds on to problems: ids stay unique
        self._renamings: dict[int, list[dict[str, str]]] = {}

    def add(self, trace: Trace) -> None:
        """Take in a trace.

        Raises
        ------
        TraceError
            If it can't be executed in its problem; ``line`` is the number of the trace, from 1.
        """
        if id(trace.problem) not in self._teams:
            self._teams[id(trace.problem)] = (trace.problem, TeamFeatures(ground_team(trace.problem)))
        team = self._teams[id(trace.problem)][1]
        try:
            execution = team.task.execute(trace.actions)
        except PlanError as error:
            raise TraceError(error.message, line=len(self.labels) + 1) from error
        self.features.append(step_features(team, execution, self.symbols))
        self.annotators.append(trace.annotator)
        self._actions.append((trace.problem, trace.actions))
        labels: list[bool | str | None] = []
        for step, operator in zip(trace.steps, execution.operators, strict=True):
            is_human = team.tables.is_human(operator)
            labels.append(True if is_human else step.label)
            if not is_human:
                self.schemas.add(step.action[0])
                self.num_labels += step.label is not None
        self.task_labels.append(labels)
        self.labels.append([None if label is None else label is not False for label in labels])

    @property
    def task_names(self) -> list[str]:
        """The tasks that annotators named, sorted."""
        return sorted({label for row in self.task_labels for label in row if isinstance(label, str)})

    @property
    def num_sequences(self) -> int:
        """How many sequences there are to train on, copies included."""
        return len(self.features) * (1 + self.num_copies)

    @property
    def step_names(self) -> set[str]:
        """Names of the features of which every robot's step has exactly one: what schema it is of."""
        return {f"step: {name}" if self.symbols == "lifted" else name for name in self.schemas}

    def sequences(self) -> Iterator[Rows]:
        """Yield the features of each trace, followed by those of its copies."""
        for rows, (problem, actions) in zip(self.features, self._actions, strict=True):
            yield rows
            if self.num_copies:
                is_human = [not row for row in rows]
                for renaming in self._renamings_of(problem):
                    yield _symbols(permute(actions, renaming), is_human)

    def answers(self) -> Iterator[list[bool | None]]:
        """Yield the labels of each sequence."""
        return (row for row in self.labels for _ in range(1 + self.num_copies))

    def given(self) -> Iterator[list[bool | None]]:
        """Yield what is known of each sequence beforehand: human steps are explicable by definition."""
        for rows in self.features:
            known = [None if row else True for row in rows]
            for _ in range(1 + self.num_copies):
                yield known

    def _renamings_of(self, problem: "TeamProblem") -> list[dict[str, str]]:
        if id(problem) not in self._renamings:
            if self._rng is None:
                raise UsageError("copies need a source of chance")
            groups = interchangeable_objects(problem.composite)
            self._renamings[id(problem)] = list(draw_permutations(self._rng, groups, self.num_copies))
        return self._renamings[id(problem)]

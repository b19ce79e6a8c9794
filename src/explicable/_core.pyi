"""Types of the compiled core; one section per file of ``cpp/bindings``."""

from array import array
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

# --- task and grounding (cpp/bindings/task.cpp) ---

_Effects = list[tuple[list[int], list[int], list[int]]]  # condition, adds, deletes

AUXILIARY: int

class TaskData: ...

class Task(TaskData):
    @staticmethod
    def from_arrays(
        variable_facts: Sequence[Sequence[int]],
        preconditions: Sequence[Sequence[int]],
        adds: Sequence[Sequence[int]],
        deletes: Sequence[Sequence[int]],
        costs: Sequence[int],
        effects: Sequence[Sequence[tuple[Sequence[int], Sequence[int], Sequence[int]]]],
        initial: Sequence[int],
        goal: Sequence[int],
        goal_reachable: bool = True,
    ) -> Task: ...
    @property
    def num_facts(self) -> int: ...
    @property
    def num_operators(self) -> int: ...
    @property
    def num_variables(self) -> int: ...
    @property
    def num_words(self) -> int: ...
    @property
    def initial(self) -> list[int]: ...
    @property
    def goal(self) -> list[int]: ...
    @property
    def goal_reachable(self) -> bool: ...
    def fact_arguments(self, fact: int) -> list[int]: ...
    def fact_predicate(self, fact: int) -> int: ...
    def fact_variable(self, fact: int) -> int: ...
    def operator_arguments(self, operator: int) -> list[int]: ...
    def operator_schema(self, operator: int) -> int: ...
    def preconditions(self, operator: int) -> list[int]: ...
    def adds(self, operator: int) -> list[int]: ...
    def deletes(self, operator: int) -> list[int]: ...
    def effects(self, operator: int) -> _Effects: ...
    def cost(self, operator: int) -> int: ...
    def variable_facts(self, variable: int) -> list[int]: ...
    def find_fact(self, predicate: int, arguments: Sequence[int]) -> int: ...
    def find_operators(self, schema: int, arguments: Sequence[int]) -> list[int]: ...
    def pack(self, facts: Sequence[int]) -> bytes: ...
    def true_facts(self, state: bytes) -> list[int]: ...
    def holds(self, state: bytes, facts: Sequence[int]) -> bool: ...
    def successor(self, state: bytes, operator: int) -> bytes: ...
    def follow(self, state: bytes, operators: Sequence[int]) -> bytes: ...
    def is_applicable(self, state: bytes, operator: int) -> bool: ...
    def applicable(self, state: bytes) -> list[int]: ...
    def array(self, name: str) -> memoryview: ...

def ground(
    structure: array[int],
    initial: Sequence[array[int]],
    num_initial: Sequence[int],
    function_arguments: Sequence[array[int]],
    function_values: Sequence[array[int]],
    memory_limit_bytes: int,
) -> Task: ...

# --- search (cpp/bindings/search.cpp) ---

class PathScorer:
    """Scores the steps of a path and a relaxed plan in labelled search."""

class CountingScorer(PathScorer):
    """Each operator counts with a fixed weight."""

    def __init__(self, weights: Sequence[float]) -> None: ...

class CallbackScorer(PathScorer):
    """Asks a Python object with these methods; a context is any value, states are packed.

    ``root(state) -> context``; ``extend(context, operator, before, after) -> context``;
    ``score(context, state, relaxed_plan) -> (num_inexplicable, variance, num_steps)``;
    ``closing_key(context) -> int``. It keeps all contexts while it lives: make a new one for each search.
    """

    def __init__(self, task: Task, callbacks: object) -> None: ...

class SearchAnswer:
    """What a search found out."""

    @property
    def outcome(self) -> str: ...
    @property
    def stop(self) -> str: ...
    @property
    def plan(self) -> list[int] | None: ...
    @property
    def cost(self) -> int: ...
    @property
    def objective(self) -> float: ...
    @property
    def lower_bound(self) -> float: ...
    @property
    def is_optimal(self) -> bool: ...
    @property
    def evaluations(self) -> int: ...
    @property
    def expansions(self) -> int: ...
    @property
    def memory_bytes(self) -> int: ...
    @property
    def search_s(self) -> float: ...

def search(
    task: Task,
    initial: bytes | None,
    goal: Sequence[int],
    *,
    algorithm: str,
    heuristic: str,
    preferred: str,
    lookahead: bool,
    weight: float,
    seed: int,
    scorer: PathScorer | None,
    closing: str,
    alpha: float,
    ratio: bool,
    max_cost: int | None,
    known_plans: Sequence[Sequence[int]],
    gap: float,
    on_better: Callable[[float], None] | None,
    interrupted: Callable[[], bool],
    time_limit_s: float,
    memory_limit_bytes: int | None,
    max_evaluations: int | None,
) -> SearchAnswer: ...

class CostsToGo:
    """Costs-to-go from a state, or from what operator ``by`` makes of it; None where a limit was met."""

    def __init__(self, task: Task, most: int) -> None: ...
    def cost(self, state: bytes, goal: Sequence[int], by: int = -1) -> float | None: ...
    def first(self, state: bytes, goal: Sequence[int], by: int = -1) -> int | None: ...
    def way(self, state: bytes, goal: Sequence[int], by: int = -1) -> list[int] | None: ...
    def learn(self, state: bytes, goal: Sequence[int], way: Sequence[int] | None) -> None: ...

def eliminate_actions(
    task: Task, initial: bytes | None, goal: Sequence[int], plan: Sequence[int]
) -> list[int]:
    """Drop steps without which the goal is reached all the same (action elimination)."""

def search_neighbourhood(
    task: Task, initial: bytes | None, goal: Sequence[int], plan: Sequence[int], max_transitions: int
) -> list[int]:
    """Give the cheapest plan among the states near those of a plan."""

def applicable_operators(task: Task, state: bytes) -> list[int]: ...
def relaxed_plan(
    task: Task, state: bytes, goal: Sequence[int], unit_costs: bool = True
) -> tuple[int, list[int]] | None:
    """h_add and a relaxed plan in an order that can be executed; None for a dead end."""

def helpful_operators(task: Task, state: bytes, goal: Sequence[int]) -> list[int]: ...
def heuristic_value(task: Task, state: bytes, goal: Sequence[int], name: str) -> float:
    """Give a lower bound by "blind", "hmax" or "lmcut"; infinite for a dead end."""

# --- labelling (cpp/bindings/labelling.cpp) ---

def state_scores(
    offsets: NDArray[np.int64],
    features: NDArray[np.int32],
    values: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Scores (rows x labels) of feature rows; empty `values`: all are 1."""

def viterbi(
    state: NDArray[np.float64], transition: NDArray[np.float64], clamped: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Most probable labels; `clamped` is empty or holds a label or -1 for each position."""

def marginals(
    state: NDArray[np.float64], transition: NDArray[np.float64], clamped: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Probabilities of labels, positions x labels."""

def count_distribution(
    state: NDArray[np.float64],
    transition: NDArray[np.float64],
    clamped: NDArray[np.int32],
    empty: int,
    counted: NDArray[np.uint8],
) -> NDArray[np.float64]:
    """Distribution of the number of counted positions with a label other than `empty`."""

class SequenceLoss:
    """Negative log-likelihood of labelled sequences and its gradient."""

    def __init__(
        self,
        num_labels: int,
        num_features: int,
        row_offsets: NDArray[np.int64],
        row_features: NDArray[np.int32],
        row_values: NDArray[np.float64],
        offsets: NDArray[np.int64],
        position_rows: NDArray[np.int32],
        position_labels: NDArray[np.int32],
        position_given: NDArray[np.int32] | None = None,
    ) -> None: ...
    def __call__(
        self, weights: NDArray[np.float64], sequence_weights: NDArray[np.float64]
    ) -> tuple[float, NDArray[np.float64]]:
        """Loss and gradient; state weights (features x labels, flat) come first, then transition weights."""

# --- scorer (cpp/bindings/scorer.cpp) ---

class TeamTables:
    """What features see of a team task."""

    max_arity: int
    @property
    def request_facts(self) -> list[list[int]]: ...
    def __init__(
        self,
        composite: Task,
        mental: Task,
        goal: list[int],
        schemas: list[int],
        predicates: list[int],
        objects: list[int],
        is_human: list[bool],
    ) -> None: ...
    def is_human(self, step: int, /) -> bool: ...
    def is_believed(self, step: int, /) -> bool: ...
    def asks_for(self, step: int, /) -> int: ...
    def fulfils(self, step: int, /) -> list[int]: ...
    def achieves(self, step: int, /) -> list[int]: ...
    def takes_back(self, step: int, earlier: int, /) -> bool: ...
    def toward_request(self, step: int, request: int) -> tuple[int, int]: ...
    def toward_goals(self, step: int, fulfilled: list[bool]) -> tuple[int, int, int]: ...

class HumanChoices:
    """What a human can do in a state, with the features of each choice."""

    def __init__(
        self,
        composite: Task,
        mental: Task,
        tables: TeamTables,
        schemas: list[int],
        predicates: list[int],
        objects: list[int],
    ) -> None: ...
    def options(self, state: bytes, requests: list[int]) -> list[tuple[int, int, bool, int, bool]]:
        """List (operator, request or -1, whether there seems to be a way, its rank, whether it is open)."""

class Scorer(PathScorer):
    """A labeller compiled for one team task; contexts are bytes."""

    def __init__(
        self,
        task: Task,
        tables: TeamTables,
        weights: list[tuple[int, tuple[int, int, int, int], float]],
        transitions: list[list[float]],
        expected: bool,
        own: list[float] = ...,
        unfamiliar: float = ...,
    ) -> None: ...
    def starting_at(self, context: bytes) -> Scorer: ...
    def charging(self, choices: HumanChoices, weights: list[float], price: float) -> Scorer:
        """Charge every path `price` for each nat of surprise at what it makes the human do."""
    def charge(self, context: bytes) -> float: ...
    def root(self, state: bytes) -> bytes: ...
    def extend(self, parent: bytes, step: int, before: bytes, after: bytes) -> bytes: ...
    def score(self, context: bytes, state: bytes, relaxed_plan: list[int]) -> tuple[float, float, int]:
        """Return the expected number of inexplicable steps, its variance, and the number of steps."""
    def count(self, context: bytes, state: bytes, relaxed_plan: list[int]) -> float:
        """Return the first of these alone, as a search asks for it: with a memory of earlier questions."""
    def count_child(
        self, parent: bytes, step: int, before: bytes, after: bytes, relaxed_plan: list[int]
    ) -> float:
        """Return the same of a child of `parent`, as a search asks for it."""
    def closing_key(self, context: bytes) -> int: ...
    def lead(self, a: bytes, b: bytes, state: bytes) -> float: ...
    def least_count(self, context: bytes) -> float: ...
    def least_growth(self, parent: bytes, step: int, child: bytes) -> float: ...
    def least_end(self, context: bytes) -> float: ...
    def outlook_key(self, context: bytes) -> int: ...
    def widen(self, context: bytes, other: bytes) -> bytes: ...

def with_telling(task: Task, num_sets: int, tellings: Sequence[tuple[int, int, int]]) -> Task:
    """Return the task in which telling is a step: (from set, to set, schema) each."""

class TellingScorer(PathScorer):
    """Scores paths of such a task: one scorer for each set that can have been told."""

    def __init__(self, task: Task, scorers: Sequence[Scorer], price: float) -> None: ...

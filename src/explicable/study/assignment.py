"""Who gets which tasks, in which order: balanced, and random where balance leaves a choice. Pure."""

from collections.abc import Hashable, Mapping, Sequence
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import numpy as np

T = TypeVar("T", bound=Hashable)


def least_used(choices: Sequence[T], uses: Mapping[T, int], rng: "np.random.Generator") -> T:
    """Return the choice that was used least so far; among equals chance decides.

    Examples
    --------
    >>> import numpy as np
    >>> least_used(["a", "b"], {"a": 2, "b": 1}, np.random.default_rng(0))
    'b'
    """
    fewest = min(uses.get(choice, 0) for choice in choices)
    equals = [choice for choice in choices if uses.get(choice, 0) == fewest]
    return equals[int(rng.integers(len(equals)))]


def draw_tasks(
    wanted: Mapping[T, int], taken: Mapping[T, int], num: int, rng: "np.random.Generator"
) -> list[T]:
    """Choose the tasks of one person: those that lack most people, none beyond what was asked for.

    Parameters
    ----------
    wanted
        How many people each task should be shown to.
    taken
        How many have finished it, or are at it.
    num
        Most tasks for one person.

    Examples
    --------
    >>> import numpy as np
    >>> draw_tasks({"a": 2, "b": 2, "c": 1}, {"a": 1, "c": 1}, 2, np.random.default_rng(0))
    ['b', 'a']
    """
    open_tasks = [task for task, people in wanted.items() if taken.get(task, 0) < people]
    shuffled = [open_tasks[int(index)] for index in rng.permutation(len(open_tasks))]
    return sorted(shuffled, key=lambda task: taken.get(task, 0) / wanted[task])[:num]


def order_tasks(
    tasks: Sequence[T], times_at: Mapping[tuple[T, int], int], rng: "np.random.Generator"
) -> list[T]:
    """Put a person's tasks into an order in which each stands where it has stood least.

    Parameters
    ----------
    tasks
        What one person gets.
    times_at
        How often each task has been at each position, counted from 1.

    Examples
    --------
    >>> import numpy as np
    >>> order_tasks(["a", "b"], {("a", 1): 1}, np.random.default_rng(0))
    ['b', 'a']
    """
    left, ordered = list(tasks), []
    for position in range(1, len(tasks) + 1):
        chosen = least_used(left, {task: times_at.get((task, position), 0) for task in left}, rng)
        left.remove(chosen)
        ordered.append(chosen)
    return ordered

"""How many people a study needs: simulated participants take part in many simulated studies of each size.

They are test instruments: the answer is as good as the guess that people differ, err and look ahead as they
do. Nobody leaves early, and the plans are those of the study: more people say nothing of other plans.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from explicable.errors import UsageError
from explicable.study.assignment import draw_tasks, least_used
from explicable.study.config import Condition, Task
from explicable.study.difference import find_differences, wilson
from explicable.study.materials import Materials
from explicable.study.onlooker import rehearse

if TYPE_CHECKING:
    from explicable.execution import Family

FEWEST = 4
"""Fewest people considered: with fewer, errors can't be estimated from how they differ."""

_Array = NDArray[np.float64]
_SHOWN = (
    4,
    6,
    8,
    10,
    12,
    16,
    20,
    24,
    32,
    40,
    48,
    64,
    80,
    100,
    128,
    160,
    200,
    256,
    320,
    400,
    500,
    640,
    800,
    1000,
)


@dataclass(frozen=True, slots=True)
class Size:
    """What studies with so many people find.

    Attributes
    ----------
    num_people, people_each
        Of a study, and of each of its tasks (in each condition, where it is played).
    power, power_low, power_high
        Share of the studies that find the difference, with a 95 % interval (Wilson) for their number.
    difference_low, difference_high
        The differences that 95 % of the studies see lie between these.
    """

    num_people: int
    people_each: int
    power: float
    power_low: float
    power_high: float
    difference_low: float
    difference_high: float


@dataclass(frozen=True, slots=True)
class Power:
    """How many people find a difference in F between two kinds of plans.

    Attributes
    ----------
    family
        Of the simulated participants.
    one, other
        What is compared: sources of replayed plans, or conditions of play.
    f_one, f_other, difference
        Share of robot steps that all simulated participants together called explicable, and the difference.
    odds_ratio
        Odds that a step of the one is called explicable, over the other's; None where they have no odds.
    needed
        Least size from which on the power is at least the target; None if no size considered has it.
    sizes
        A selection of the sizes considered, with the one needed.
    target, num_studies, num_participants, seed
        Power asked for; simulated studies, and simulated participants that they were drawn from.
    """

    family: str
    one: str
    other: str
    f_one: float
    f_other: float
    difference: float
    odds_ratio: float | None
    needed: int | None
    sizes: tuple[Size, ...]
    target: float
    num_studies: int
    num_participants: int
    seed: int

    def as_dict(self) -> dict[str, Any]:
        """Return everything as values that JSON has."""
        return asdict(self)


def arm_of(task: Task, condition: Condition) -> str:
    """Return what a task can be compared by: a plan by what made it, play by its condition."""
    return task.source if task.kind == "replay" else condition.name


def arms(materials: Materials) -> list[str]:
    """Return everything in a study that can be compared."""
    pairs = [(task, condition) for condition in materials.study.conditions for task in materials.study.task]
    return sorted({arm_of(task, condition) for task, condition in pairs})


def analyse(
    materials: Materials,
    family: "Family",
    one: str,
    other: str,
    *,
    most: int = 100,
    target: float = 0.8,
    num_studies: int = 500,
    seed: int = 0,
    tell: Callable[[float], None] = lambda _: None,
) -> Power:
    """Work out how many people a study needs to find the difference in F between two kinds of plans.

    Parameters
    ----------
    one, other
        Two of `arms`.
    most
        Largest size considered; so many simulated participants, at least 200, label each task once.
    target
        Power asked for.
    num_studies
        Simulated studies. Each draws its people anew and gives them tasks as the study does.
    tell
        Is told the share of the work that is done.

    Raises
    ------
    UsageError
        If the study has nothing of the kind to compare, or a size makes no sense.
    """
    known = arms(materials)
    if one == other or not {one, other} <= set(known):
        raise UsageError(f"{one!r} and {other!r} can't be compared: the study has {', '.join(known)}")
    if most < FEWEST:
        raise UsageError(f"at least {FEWEST} people are needed to see how they differ, not {most}")
    said = _rehearsals(materials, family, max(most, 200), seed, tell)
    compared = np.array([_marks(materials, arm) for arm in (one, other)])
    studies = np.empty((num_studies, most, 2, 2))
    for number in range(num_studies):
        studies[number] = _study(materials, said, compared, most, np.random.default_rng((seed, 1, number)))
    sizes = {size: _size(materials, studies[:, :size], size) for size in range(FEWEST, most + 1)}
    too_few = [size for size, found in sizes.items() if found.power < target]
    needed = max(too_few, default=FEWEST - 1) + 1
    shown = sorted({*_SHOWN, most, needed} & set(sizes))
    yes, asked = np.einsum("kcts,act->sa", said, compared)
    f_one, f_other = yes / asked
    odds = yes / np.where(asked > yes, asked - yes, np.nan)
    return Power(
        family=family.name,
        one=one,
        other=other,
        f_one=float(f_one),
        f_other=float(f_other),
        difference=float(f_one - f_other),
        odds_ratio=float(odds[0] / odds[1]) if np.isfinite(odds).all() and odds[1] > 0 else None,
        needed=needed if needed <= most else None,
        sizes=tuple(sizes[size] for size in shown),
        target=target,
        num_studies=num_studies,
        num_participants=len(said),
        seed=seed,
    )


def _rehearsals(
    materials: Materials, family: "Family", num: int, seed: int, tell: Callable[[float], None]
) -> _Array:
    """Let participants do every task in every condition: (participants, conditions, tasks, yes and asked)."""
    study = materials.study
    said = np.zeros((num, len(study.conditions), len(study.task), 2))
    for number in range(num):
        rng = np.random.default_rng((seed, 0, number))
        participant = family.draw(number + 1, rng)
        for c, condition in enumerate(study.conditions):
            for t, task in enumerate(study.task):
                steps = rehearse(materials.material(task.name, condition.name), participant, rng)
                labels = [bool(step.label) for step in steps if step.label is not None]
                said[number, c, t] = sum(labels), len(labels)
        tell((number + 1) / num)
    return said


def _marks(materials: Materials, arm: str) -> _Array:
    """Mark what belongs to one side of the comparison: (conditions, tasks), ones and zeros."""
    study = materials.study
    return np.array([[arm_of(task, c) == arm for task in study.task] for c in study.conditions], float)


def _study(
    materials: Materials, said: _Array, compared: _Array, num: int, rng: np.random.Generator
) -> _Array:
    """Draw people, give them conditions and tasks as the study does: (people, sides, yes and asked)."""
    study = materials.study
    people = rng.integers(len(said), size=num)
    conditions = [condition.name for condition in study.conditions]
    wanted = {task.name: task.people * 10**6 for task in study.task}  # as many as come, in the same shares
    index = {name: number for number, name in enumerate(wanted)}
    uses: dict[str, int] = defaultdict(int)
    taken: dict[tuple[str, str], int] = defaultdict(int)
    kinds = {task.name: task.kind for task in study.task}
    found = np.zeros((num, 2, 2))
    for place, person in enumerate(people):
        condition = least_used(conditions, uses, rng)
        uses[condition] += 1
        scope = {name: condition if kinds[name] == "play" else "" for name in wanted}
        counts = {name: taken[name, scope[name]] for name in wanted}
        for name in draw_tasks(wanted, counts, study.tasks_each, rng):
            taken[name, scope[name]] += 1
            c, t = conditions.index(condition), index[name]
            found[place] += compared[:, c, t, None] * said[person, c, t]
    return found


def _size(materials: Materials, studies: _Array, num_people: int) -> Size:
    difference, is_significant = find_differences(studies)
    power, num = float(is_significant.mean()), len(studies)
    middle, half = wilson(power, num)
    low, high = (float(end) for end in np.quantile(difference, (0.025, 0.975)))
    study = materials.study
    in_conditions = len(study.conditions) if any(task.kind == "play" for task in study.task) else 1
    each = min(study.tasks_each, len(study.task)) * num_people / (len(study.task) * in_conditions)
    return Size(num_people, int(np.ceil(each)), power, middle - half, middle + half, low, high)


def say(powers: Sequence[Power], most: int) -> str:
    """Answer in one sentence how many people are needed.

    Examples
    --------
    >>> power = Power("myopic", "new", "ff", 0.9, 0.7, 0.2, 3.9, 12, (), 0.8, 500, 200, 0)
    >>> say([power], 100)
    '12 people find the difference in F between new and ff in 80 % of studies (myopic).'
    """
    found = sorted((power.needed, power.family) for power in powers if power.needed is not None)
    missed = [power.family for power in powers if power.needed is None]
    what = f"the difference in F between {powers[0].one} and {powers[0].other}"
    share = f"in {100 * powers[0].target:.0f} % of studies"
    if not found:
        return f"Even {most} people don't find {what} {share} ({', '.join(missed)})."
    (low, first), (high, last) = found[0], found[-1]
    numbers = f"{low}" if low == high else f"Between {low} ({first}) and {high} ({last})"
    families = f" ({', '.join(family for _, family in found)})" if low == high else ""
    rest = f"; for {', '.join(missed)} not even {most} are enough" if missed else ""
    return f"{numbers} people find {what} {share}{families}{rest}."

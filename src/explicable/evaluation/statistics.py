"""Statistics of trials in which the same participants meet the same problems: nothing is independent here.

Observations are counts: so many of so many steps, of one problem and one participant. Ratios are pooled (sums
over sums), intervals come from a bootstrap that draws problems and participants anew, both with replacement.
"""

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from explicable.errors import UsageError

NUM_DRAWS = 1000
"""Of the bootstrap."""

_SEED = 20
_Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Estimate:
    """A figure with its 95 % interval.

    Attributes
    ----------
    value
        The ratio, mean or difference.
    low, high
        Ends of the interval; both are the value where there is but one cluster.
    num
        Observations that it rests on.
    num_clusters
        Different problems among them.
    """

    value: float
    low: float
    high: float
    num: int
    num_clusters: int

    @property
    def excludes_zero(self) -> bool:
        """Whether zero lies outside the interval."""
        return self.low > 0 or self.high < 0


@dataclass(frozen=True)
class Counts:
    """Counts of several observations, and the clusters that they belong to.

    Parameters
    ----------
    part, whole
        So many of so many, by observation. For a mean, the values and ones.
    problems, participants
        Whose observation it is; participants may be all the same, where there are none.
    """

    part: Sequence[float]
    whole: Sequence[float]
    problems: Sequence[Hashable]
    participants: Sequence[Hashable]

    def __post_init__(self) -> None:
        lengths = {len(self.part), len(self.whole), len(self.problems), len(self.participants)}
        if len(lengths) != 1 or not len(self.part):
            raise UsageError("counts need one part, whole, problem and participant for each observation")


def estimate(counts: Counts, *, num_draws: int = NUM_DRAWS) -> Estimate:
    """Estimate a pooled ratio, with an interval from the pigeonhole bootstrap.

    Notes
    -----
    Weights of problems and of participants are drawn apart and multiplied (Owen, "The pigeonhole bootstrap",
    Annals of Applied Statistics 1, 2007), which is cautious where both matter.

    Examples
    --------
    >>> counts = Counts([8, 9, 5, 7], [10, 10, 10, 10], ["a", "a", "b", "b"], ["x", "y", "x", "y"])
    >>> found = estimate(counts)
    >>> found.value, found.low <= found.value <= found.high, found.num_clusters
    (0.725, True, 2)
    """
    (draws,) = _draw_ratios([counts], num_draws)
    return _summarise(_ratio(counts), draws, counts)


def estimate_difference(one: Counts, other: Counts, *, num_draws: int = NUM_DRAWS) -> Estimate:
    """Estimate the difference of two pooled ratios, problems and participants drawn alike for both.

    Examples
    --------
    >>> one = Counts([9, 8], [10, 10], ["a", "b"], ["x", "x"])
    >>> other = Counts([7, 6], [10, 10], ["a", "b"], ["x", "x"])
    >>> round(estimate_difference(one, other).value, 3)
    0.2
    """
    draws, others = _draw_ratios([one, other], num_draws)
    return _summarise(_ratio(one) - _ratio(other), draws - others, one)


def estimate_ratio(one: Counts, other: Counts, *, num_draws: int = NUM_DRAWS) -> Estimate:
    """Estimate the quotient of two pooled ratios, drawn as in `estimate_difference`."""
    draws, others = _draw_ratios([one, other], num_draws)
    return _summarise(_ratio(one) / _ratio(other), draws / others, one)


def standardised_difference(one: Sequence[float], other: Sequence[float]) -> float:
    """Return Cohen's d of paired values: the mean difference in units of the differences' deviation.

    Examples
    --------
    >>> round(standardised_difference([3, 4, 5], [1, 3, 3]), 2)
    2.89
    """
    differences = np.array(one, float) - np.array(other, float)
    deviation = differences.std(ddof=1) if len(differences) > 1 else 0.0
    return float(differences.mean() / deviation) if deviation > 0 else 0.0


def power_curve(
    one: Counts, other: Counts, sizes: Sequence[int], *, num_studies: int = 200, num_draws: int = 200
) -> list[tuple[int, float]]:
    """Return how often studies with so many problems would find the difference, were it as estimated here.

    A study draws problems with replacement from those there are; it finds the difference if its own interval
    excludes zero.

    Returns
    -------
    list of (number of problems, share of studies)
    """
    problems = sorted(set(one.problems), key=str)
    gains = np.array([_of_problem(one, problem) - _of_problem(other, problem) for problem in problems])
    rng = np.random.default_rng(_SEED)
    curve = []
    for size in sizes:
        studies = gains[rng.integers(len(gains), size=(num_studies, size))]
        means = studies[:, rng.integers(size, size=(num_draws, size))].mean(axis=2)
        low, high = np.quantile(means, (0.025, 0.975), axis=1)
        curve.append((size, float(((low > 0) | (high < 0)).mean())))
    return curve


@dataclass(frozen=True, slots=True)
class Effect:
    """What a generalised estimating equation says of one plan against a reference.

    Attributes
    ----------
    name
        Of the plan.
    odds_ratio, low, high
        Odds that a step is explicable, over the reference's, with a 95 % interval.
    p_value
        Of no difference, after Holm's correction for all comparisons made together.
    num
        Observations.
    """

    name: str
    odds_ratio: float
    low: float
    high: float
    p_value: float
    num: int


def compare_with_gee(counts: dict[str, Counts], reference: str) -> list[Effect]:
    """Compare plans by a logistic model of single answers, exchangeable within problems.

    Plans all of whose answers are alike are left out: their odds are no number.

    Raises
    ------
    UsageError
        If there are fewer than two problems.

    Notes
    -----
    Liang & Zeger, "Longitudinal data analysis using generalized linear models", Biometrika 73, 1986; robust
    errors. Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Statistics 6, 1979.
    """
    from statsmodels.genmod.cov_struct import Exchangeable
    from statsmodels.genmod.families import Binomial
    from statsmodels.genmod.generalized_estimating_equations import GEE

    others = [name for name in counts if name != reference and 0 < _ratio(counts[name]) < 1]
    if not others or not 0 < _ratio(counts[reference]) < 1:
        return []
    answers, design, groups = _as_regression([counts[name] for name in (reference, *others)])
    if groups.max() < 1:
        raise UsageError("a comparison needs at least two problems")
    order = np.argsort(groups, kind="stable")  # as the library wants them: one problem after another
    model = GEE(
        answers[order], design[order], groups=groups[order], family=Binomial(), cov_struct=Exchangeable()
    )
    fitted = model.fit()
    # Where both gave the same answers to everything, nothing varies, and there is no error to divide by.
    is_same = np.abs(fitted.params[1:]) < 1e-12
    corrected = correct_by_holm(np.where(is_same, 1.0, fitted.pvalues[1:]).tolist())
    ends = np.exp(np.where(is_same[:, None], 0.0, fitted.conf_int()[1:]))
    return [
        Effect(
            name,
            float(np.exp(fitted.params[k + 1])),
            float(ends[k, 0]),
            float(ends[k, 1]),
            float(p),
            len(answers),
        )
        for k, (name, p) in enumerate(zip(others, corrected, strict=True))
    ]


def _as_regression(plans: Sequence[Counts]) -> tuple[_Array, _Array, NDArray[np.int64]]:
    """Return, by observation: yes and no; a constant, and which of the later plans it is of; its problem."""
    part = np.concatenate([np.array(plan.part, float) for plan in plans])
    whole = np.concatenate([np.array(plan.whole, float) for plan in plans])
    design = np.eye(len(plans)).repeat([len(plan.part) for plan in plans], axis=0)
    design[:, 0] = 1.0
    problems = [problem for plan in plans for problem in plan.problems]
    numbers = _number(problems)
    return np.column_stack([part, whole - part]), design, np.array([numbers[name] for name in problems])


def correct_by_holm(p_values: Sequence[float]) -> list[float]:
    """Correct p values of comparisons made together.

    The least is multiplied by the number of comparisons, the next by one less, and so on; none falls below a
    lesser one.

    Examples
    --------
    >>> correct_by_holm([0.25, 0.125, 0.5])
    [0.5, 0.375, 0.5]
    """
    order = np.argsort(p_values, kind="stable")
    factors = np.arange(len(order), 0, -1)
    corrected = np.empty(len(order))
    corrected[order] = np.minimum(np.maximum.accumulate(np.asarray(p_values)[order] * factors), 1.0)
    return [float(p) for p in corrected]


def _draw_ratios(counts: Sequence[Counts], num_draws: int) -> list[_Array]:
    """Return pooled ratios of each counts, clusters drawn anew; a cluster weighs the same in all counts."""
    problems = _number(name for c in counts for name in c.problems)
    people = _number(name for c in counts for name in c.participants)
    by_problem, by_person = _draw_weights(len(problems), len(people), num_draws)
    ratios = []
    for c in counts:
        cells = [problems[name] for name in c.problems], [people[name] for name in c.participants]
        table = np.zeros((2, len(problems), len(people)))
        for values, into in zip((c.part, c.whole), table, strict=True):
            np.add.at(into, cells, values)
        part, whole = ((by_problem @ values * by_person).sum(axis=1) for values in table)
        ratios.append(np.divide(part, whole, out=np.full(num_draws, np.nan), where=whole > 0))
    return ratios


def _number(names: Iterable[Hashable]) -> dict[Hashable, int]:
    return {name: number for number, name in enumerate(dict.fromkeys(names))}


@lru_cache(maxsize=32)  # a page asks for the same few again and again
def _draw_weights(num_problems: int, num_people: int, num_draws: int) -> tuple[_Array, _Array]:
    """Draw weights of problems and of participants (draws x clusters); what is alone weighs one."""
    rng = np.random.default_rng(_SEED)
    by_problem, by_person = (
        rng.multinomial(num, np.full(num, 1 / num), size=num_draws).astype(float)
        if num > 1
        else np.ones((num_draws, 1))
        for num in (num_problems, num_people)
    )
    return by_problem, by_person


def _ratio(counts: Counts) -> float:
    part, whole = sum(counts.part), sum(counts.whole)
    return float(part / whole) if whole else float("nan")


def _of_problem(counts: Counts, problem: Hashable) -> float:
    chosen = [place for place, name in enumerate(counts.problems) if name == problem]
    return sum(counts.part[k] for k in chosen) / max(sum(counts.whole[k] for k in chosen), 1e-9)


def _summarise(value: float, draws: _Array, counts: Counts) -> Estimate:
    found = draws[np.isfinite(draws)]
    low, high = np.quantile(found, (0.025, 0.975)) if len(found) else (value, value)
    return Estimate(value, float(low), float(high), len(counts.part), len(set(counts.problems)))

"""Intervals cover, pairs cancel, odds ratios are those of the table."""

import numpy as np
import pytest
from statsmodels.stats.multitest import multipletests

from explicable.errors import UsageError
from explicable.evaluation.statistics import (
    Counts,
    compare_with_gee,
    correct_by_holm,
    estimate,
    estimate_difference,
    estimate_ratio,
    power_curve,
    standardised_difference,
)


def crossed(rng, num_problems=20, num_participants=12, shift=0.0):
    """Twenty steps each; problems and participants differ, so that answers are far from independent."""
    problems, participants = rng.normal(0, 0.6, num_problems), rng.normal(0, 0.6, num_participants)
    rows = [(p, q) for p in range(num_problems) for q in range(num_participants)]
    chance = [1 / (1 + np.exp(-(1.0 + shift + problems[p] + participants[q]))) for p, q in rows]
    part = rng.binomial(20, chance)
    return Counts(part.tolist(), [20] * len(rows), [p for p, _ in rows], [q for _, q in rows])


def test_intervals_cover_the_truth_where_answers_are_clustered():
    rng = np.random.default_rng(1)
    truth = np.mean([sum(c.part) / sum(c.whole) for c in (crossed(rng, 60, 60) for _ in range(60))])
    found = [estimate(crossed(rng), num_draws=300) for _ in range(120)]
    covered = np.mean([one.low <= truth <= one.high for one in found])
    assert 0.9 <= covered <= 1.0  # a bootstrap of single answers covers about half of the time


def test_what_is_the_same_in_both_cancels():
    counts = crossed(np.random.default_rng(2))
    same = estimate_difference(counts, counts)
    assert (same.value, same.low, same.high) == (0, 0, 0)
    assert not same.excludes_zero
    assert estimate_ratio(counts, counts).high == pytest.approx(1)


def test_a_difference_between_pairs_is_surer_than_one_between_strangers():
    rng = np.random.default_rng(3)
    one = crossed(rng)
    better = Counts([min(p + 1, 20) for p in one.part], one.whole, one.problems, one.participants)
    strangers = Counts(
        better.part, one.whole, [-p - 1 for p in one.problems], [-q - 1 for q in one.participants]
    )
    paired, unpaired = estimate_difference(better, one), estimate_difference(strangers, one)
    assert paired.value == pytest.approx(unpaired.value)
    assert paired.high - paired.low < (unpaired.high - unpaired.low) / 3
    assert paired.excludes_zero


def test_the_same_data_give_the_same_interval_and_one_cluster_gives_none():
    counts = crossed(np.random.default_rng(4))
    assert estimate(counts) == estimate(counts)
    lone = estimate(Counts([3], [4], ["p"], ["q"]))
    assert (lone.low, lone.value, lone.high, lone.num, lone.num_clusters) == (0.75, 0.75, 0.75, 1, 1)


def test_odds_ratios_of_the_equations_are_those_of_the_table():
    one = Counts([29, 30, 31], [40, 40, 40], [1, 2, 3], [0, 0, 0])
    other = Counts([19, 21, 20], [40, 40, 40], [1, 2, 3], [0, 0, 0])
    (effect,) = compare_with_gee({"base": other, "plan": one}, "base")
    assert effect.odds_ratio == pytest.approx((30 / 10) / (20 / 20), rel=1e-3)
    assert effect.num == 6


def test_plans_that_all_call_explicable_have_no_odds_and_the_same_answers_are_no_difference():
    some, all_ = (Counts(part, [9] * 3, [0, 1, 2], [0] * 3) for part in ([5, 6, 7], [9, 9, 9]))
    (same,) = compare_with_gee({"base": some, "perfect": all_, "same": some}, "base")
    assert same.name == "same"
    assert (same.odds_ratio, same.low, same.high, same.p_value) == pytest.approx((1.0, 1.0, 1.0, 1.0))
    assert compare_with_gee({"base": all_, "plan": some}, "base") == []


def test_many_comparisons_make_each_less_sure():
    rng = np.random.default_rng(5)
    counts = {
        name: crossed(rng, shift=shift) for name, shift in [("a", 0), ("b", 0.1), ("c", 0.2), ("d", 0.3)]
    }
    together = {effect.name: effect.p_value for effect in compare_with_gee(counts, "a")}
    for name in "bcd":
        (alone,) = compare_with_gee({"a": counts["a"], name: counts[name]}, "a")
        assert together[name] >= alone.p_value * 0.5  # correlations are estimated anew
    assert min(together.values()) <= max(together.values()) <= 1


def test_corrected_p_values_are_those_of_statsmodels():
    p_values = np.random.default_rng(7).beta(0.3, 1.0, (20, 6)).round(2)  # with ties
    for row in p_values:
        assert correct_by_holm(row) == pytest.approx(multipletests(row, method="holm")[1])


def test_power_grows_with_the_number_of_problems():
    rng = np.random.default_rng(6)
    one = crossed(rng, 40, 2)
    gain = rng.binomial(2, 0.3, len(one.part))
    better = Counts(
        [min(p + g, 20) for p, g in zip(one.part, gain, strict=True)],
        one.whole,
        one.problems,
        one.participants,
    )
    curve = dict(power_curve(better, one, (3, 10, 80)))
    assert curve[80] > 0.95
    assert curve[80] >= curve[10]


def test_effect_sizes_of_constant_differences_are_not_infinite():
    assert standardised_difference([1, 2], [0, 1]) == 0.0
    assert standardised_difference([1], [0]) == 0.0


def test_counts_of_unequal_length_are_refused():
    with pytest.raises(UsageError, match="one part, whole, problem and participant"):
        Counts([1], [2, 3], ["a"], ["b"])
    lone = Counts([3], [4], ["p"], ["q"])
    with pytest.raises(UsageError, match="at least two problems"):
        compare_with_gee({"a": lone, "b": lone}, "a")

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from explicable.execution import num_changes

plans = st.lists(st.sampled_from([("go", "a"), ("go", "b"), ("wait",)]), max_size=7).map(tuple)


def is_subsequence(part, whole):
    rest = iter(whole)
    return all(step in rest for step in part)


@given(plans, plans)
def test_changes_are_what_the_longest_kept_part_leaves_out(announced, proposed):
    kept = max(
        size
        for size in range(len(announced) + 1)
        if any(is_subsequence(part, proposed) for part in combinations(announced, size))
    )
    assert num_changes(announced, proposed) == len(announced) - kept


@given(plans, plans)
def test_what_is_added_changes_nothing(announced, added):
    assert num_changes(announced, announced + added) == num_changes(announced, added + announced) == 0

"""Random tiny tasks for hypothesis."""

from hypothesis import strategies as st

from oracles.tiny_tasks import TinyEffect, TinyOperator, TinyTask


@st.composite
def tiny_tasks(draw, conditional=True, min_cost=0, max_facts=6, max_operators=8):
    num_facts = draw(st.integers(1, max_facts))
    facts = st.frozensets(st.integers(0, num_facts - 1), max_size=2)
    none = st.just(frozenset())

    def effects(condition):
        return st.builds(
            lambda c, adds, deletes: TinyEffect(c, adds, deletes - adds), condition, facts, facts
        )

    more = st.lists(effects(facts), max_size=2 if conditional else 0)
    operators = st.builds(
        lambda precondition, first, rest, cost: TinyOperator(precondition, (first, *rest), cost),
        facts,
        effects(none),
        more,
        st.integers(min_cost, 3),
    )
    return TinyTask(
        num_facts,
        tuple(draw(st.lists(operators, max_size=max_operators))),
        draw(facts),
        draw(st.frozensets(st.integers(0, num_facts - 1), min_size=1, max_size=3)),
    )

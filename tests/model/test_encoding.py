"""The encoded problem at the core's door: whatever comes in, there is a task or an error."""

from array import array

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explicable import _core
from explicable.errors import UsageError
from explicable.model.encoding import encode
from explicable.model.problem import And, Domain, Not, Problem
from oracles.random_problems import ProblemMaker

MEMORY_LIMIT_BYTES = 16 << 20


def ground_arrays(structure, initial, num_initial, function_arguments, function_values):
    return _core.ground(
        structure, initial, num_initial, function_arguments, function_values, MEMORY_LIMIT_BYTES
    )


def arrays_of(encoded):
    return [
        encoded.structure,
        encoded.initial,
        encoded.num_initial,
        encoded.function_arguments,
        encoded.function_values,
    ]


@settings(max_examples=300)
@given(st.randoms(use_true_random=True))
def test_damaged_encodings_are_refused_or_grounded(rng):
    arrays = arrays_of(encode(ProblemMaker(rng).problem()))
    structure = array("i", arrays[0])
    for _ in range(rng.choice([1, 1, 2, 5])):
        place = rng.randrange(len(structure))
        match rng.choice(["change", "change", "remove", "insert", "arguments"]):
            case "change":
                structure[place] = rng.choice(
                    [structure[place] + rng.choice([-1, 1]), rng.randint(-9, 9), 2**31 - 1]
                )
            case "remove":
                del structure[place]
            case "insert":
                structure.insert(place, rng.randint(-4, 9))
            case "arguments":
                row = rng.choice(arrays[1])
                row.append(rng.randint(-2, 99))
    arrays[0] = structure
    try:
        task = ground_arrays(*arrays)
    except (ValueError, MemoryError):
        return
    state = task.pack(task.initial)
    for operator in task.applicable(state)[:3]:
        assert task.true_facts(task.successor(state, operator)) is not None


@pytest.mark.parametrize("depth", [400, 100_000])
def test_deep_nesting_is_an_error(depth):
    formula = And()
    for _ in range(depth):
        formula = Not(formula)
    domain = Domain("d", frozenset(), {}, {}, (), (), ())
    problem = Problem("p", domain, {}, (), formula, {})
    if depth < 500:
        ground_arrays(*arrays_of(encode(problem)))
    else:
        with pytest.raises(UsageError, match="nested too deeply"):
            encode(problem)


def test_numbers_beyond_the_cores_are_refused():
    domain = Domain("d", frozenset(), {}, {}, (), (), ())
    problem = Problem("p", domain, {}, (), And(), {("price",): 2**40})
    with pytest.raises(UsageError, match="'price'"):
        encode(problem)

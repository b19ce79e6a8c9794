"""Damaged files: each gives a task, whose model survives writing and reading, or an error of ours."""

import random
import re

import pytest

from explicable.errors import InputError, PDDLError
from explicable.model.grounding import ground
from explicable.pddl import (
    format_domain,
    format_problem,
    initial_state,
    parse_domain,
    parse_problem,
    read_domain,
)

DOMAIN = """\
; Everything that the reader knows, in one domain.
(define (domain depot)
  (:requirements :adl :action-costs)
  (:types place truck parcel - object
          van - truck
          letter - (either parcel object))
  (:constants gate - place)
  (:predicates (at ?x - (either truck parcel) ?p - place) (road ?from ?to - place)
               (in ?x - parcel ?t - truck) (locked))
  (:functions (total-cost) - number (length ?from ?to - place) - number)
  (:action drive
    :parameters (?t - truck ?from ?to - place)
    :precondition (and (at ?t ?from) (or (road ?from ?to) (road ?to ?from))
                       (imply (= ?to gate) (not (locked))))
    :effect (and (at ?t ?to) (not (at ?t ?from)) (increase (total-cost) (length ?from ?to))))
  (:action empty
    :parameters (?t - van ?p - place)
    :precondition (and (at ?t ?p) (exists (?x - parcel) (in ?x ?t)))
    :effect (and (forall (?x - parcel) (when (in ?x ?t) (and (at ?x ?p) (not (in ?x ?t)))))
                 (increase (total-cost) 2)))
  (:action lock :effect (locked)))
"""
PROBLEM = """\
(define (problem round)
  (:domain depot)
  (:objects home - place t1 - van t2 - truck box - parcel note - letter)
  (:init (at t1 gate) (at t2 home) (road gate home) (in box t1) (not (locked))
         (= (total-cost) 0) (= (length gate home) 7)
         (= (length home gate) 8))
  (:goal (and (at box home) (forall (?x - parcel) (not (in ?x t2)))))
  (:metric minimize (total-cost)))
"""
TOKENS = sorted(set(re.findall(r"[()]|\?[^\s()?]*|[^\s()?]+", DOMAIN + PROBLEM)))
STRANGE = [
    "\0",
    "\ufeff",
    "\u2028",
    "İ",
    "?",
    ";",
    ":",
    "-",
    "--",
    "9" * 30,
    "-1",
    "1.5",
    "(((",
    ")))",
    "\r",
    "\x1c",
]


def damage(text, rng):
    """Change a few places: drop, repeat, move or replace tokens, or put something strange in."""
    pieces = re.findall(r"\s+|[()]|\?[^\s()?]*|[^\s()?]+", text)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        start = rng.randrange(len(pieces))
        stop = min(len(pieces), start + rng.choice((1, 1, 1, 2, 4, 20)))
        match rng.randrange(6):
            case 0:
                del pieces[start:stop]
            case 1:
                pieces[start:start] = pieces[start:stop]
            case 2:
                moved = pieces[start:stop]
                del pieces[start:stop]
                target = rng.randrange(len(pieces) + 1)
                pieces[target:target] = moved
            case 3:
                pieces[start] = rng.choice(TOKENS)
            case 4:
                pieces.insert(start, rng.choice(STRANGE))
            case 5:
                cut = rng.randrange(len(pieces[start]) + 1)
                pieces[start] = pieces[start][:cut] + chr(rng.randrange(32, 127)) + pieces[start][cut + 1 :]
        if not pieces:
            break
    return "".join(pieces)


def read(domain_text, problem_text):
    """The problem, or what is wrong with it."""
    try:
        domain = parse_domain(domain_text, warn=str)
        return parse_problem(problem_text, domain, warn=str)
    except InputError as error:
        return error


def survives(rng):
    """Read one damaged pair; say whether it still was a task."""
    texts = [DOMAIN, PROBLEM]
    spoilt = rng.random() < 0.4
    texts[spoilt] = damage(texts[spoilt], rng)
    problem = read(*texts)
    if isinstance(problem, InputError):
        num_lines = max(len(re.findall(r"\r\n?|\n", text)) for text in texts) + 1
        assert 1 <= problem.line <= num_lines
        assert problem.column >= 1
        return False
    assert read(format_domain(problem.domain), format_problem(problem)) == problem
    assert ground(problem).num_facts >= 0
    return True


def check(num_files, seed):
    rng = random.Random(seed)
    num_tasks = sum(survives(rng) for _ in range(num_files))
    assert 0.05 < num_tasks / num_files < 0.6  # else the damage is too hard or too soft to be a test


def test_damaged_files_give_a_task_or_an_error():
    check(1000, seed=1)


@pytest.mark.slow
def test_a_hundred_thousand_damaged_files_give_a_task_or_an_error():
    check(100_000, seed=2)


def test_the_fast_way_through_initial_states_reads_as_the_careful_one(monkeypatch):
    rng = random.Random(3)
    before, _, rest = PROBLEM.partition("(:init")
    init, _, after = rest.partition("(:goal")
    texts = [f"{before}(:init{damage(init, rng)}(:goal{after}" for _ in range(250)]
    fast = [read(DOMAIN, text) for text in texts]
    monkeypatch.setattr(initial_state, "_read_plain", lambda cursor, *_: cursor.start)
    careful = [read(DOMAIN, text) for text in texts]
    assert list(map(str, fast)) == list(map(str, careful))


def test_damaged_bytes_give_a_domain_or_an_error(tmp_path):
    rng = random.Random(4)
    path = tmp_path / "domain.pddl"
    num_errors = 0
    for _ in range(200):
        data = bytearray(DOMAIN.encode())
        for _ in range(rng.choice((1, 1, 3))):
            data[rng.randrange(len(data))] = rng.randrange(256)
        path.write_bytes(data)
        try:
            read_domain(path)
        except PDDLError as error:
            num_errors += str(error).startswith(f"{path}:")
    assert num_errors > 50

"""Planning tasks of any size, made from a seed: each function gives the text of a domain and of a problem."""

from collections.abc import Iterable

import numpy as np

from explicable.first_response.encoding import Semantics, encode
from explicable.first_response.generator import generate
from explicable.pddl import format_domain, format_problem

Texts = tuple[str, str]

GRIPPER = """\
(define (domain gripper)
  (:requirements :strips :typing)
  (:types room ball gripper)
  (:predicates (at-robby ?r - room) (at ?b - ball ?r - room) (free ?g - gripper)
    (carry ?b - ball ?g - gripper))
  (:action move
    :parameters (?from ?to - room)
    :precondition (at-robby ?from)
    :effect (and (at-robby ?to) (not (at-robby ?from))))
  (:action pick
    :parameters (?b - ball ?r - room ?g - gripper)
    :precondition (and (at ?b ?r) (at-robby ?r) (free ?g))
    :effect (and (carry ?b ?g) (not (at ?b ?r)) (not (free ?g))))
  (:action drop
    :parameters (?b - ball ?r - room ?g - gripper)
    :precondition (and (carry ?b ?g) (at-robby ?r))
    :effect (and (at ?b ?r) (free ?g) (not (carry ?b ?g)))))
"""

BLOCKS = """\
(define (domain blocks)
  (:requirements :strips)
  (:predicates (on ?x ?y) (on-table ?x) (clear ?x) (hand-empty) (holding ?x))
  (:action pick-up
    :parameters (?x)
    :precondition (and (clear ?x) (on-table ?x) (hand-empty))
    :effect (and (holding ?x) (not (on-table ?x)) (not (clear ?x)) (not (hand-empty))))
  (:action put-down
    :parameters (?x)
    :precondition (holding ?x)
    :effect (and (clear ?x) (hand-empty) (on-table ?x) (not (holding ?x))))
  (:action stack
    :parameters (?x ?y)
    :precondition (and (holding ?x) (clear ?y))
    :effect (and (clear ?x) (hand-empty) (on ?x ?y) (not (holding ?x)) (not (clear ?y))))
  (:action unstack
    :parameters (?x ?y)
    :precondition (and (on ?x ?y) (clear ?x) (hand-empty))
    :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (hand-empty)) (not (on ?x ?y)))))
"""

LOGISTICS = """\
(define (domain logistics)
  (:requirements :strips :typing)
  (:types
    truck airplane - vehicle
    package vehicle - thing
    airport - location
    city location thing - object)
  (:predicates (at ?x - thing ?l - location) (in ?p - package ?v - vehicle) (part-of ?l - location ?c - city))
  (:action drive
    :parameters (?t - truck ?from ?to - location ?c - city)
    :precondition (and (at ?t ?from) (part-of ?from ?c) (part-of ?to ?c))
    :effect (and (at ?t ?to) (not (at ?t ?from))))
  (:action fly
    :parameters (?a - airplane ?from ?to - airport)
    :precondition (at ?a ?from)
    :effect (and (at ?a ?to) (not (at ?a ?from))))
  (:action load
    :parameters (?p - package ?v - vehicle ?l - location)
    :precondition (and (at ?p ?l) (at ?v ?l))
    :effect (and (in ?p ?v) (not (at ?p ?l))))
  (:action unload
    :parameters (?p - package ?v - vehicle ?l - location)
    :precondition (and (in ?p ?v) (at ?v ?l))
    :effect (and (at ?p ?l) (not (in ?p ?v)))))
"""


def gripper(num_balls: int) -> Texts:
    """Carry balls to the other room, two at a time; a plan has about three steps for each ball."""
    balls = _names("ball", num_balls)
    problem = _problem(
        f"gripper-{num_balls}",
        "gripper",
        {"room": ["here", "there"], "gripper": ["left", "right"], "ball": balls},
        ["(at-robby here)", "(free left)", "(free right)", *(f"(at {ball} here)" for ball in balls)],
        (f"(at {ball} there)" for ball in balls),
    )
    return GRIPPER, problem


def blocks(num_blocks: int, seed: int = 0) -> Texts:
    """Build towers drawn at random from other towers drawn at random."""
    rng = np.random.default_rng(seed)
    names = _names("b", num_blocks)
    initial = _towers(names, rng)
    covered = {below for below in initial.values() if below is not None}
    init = [_placed(block, below) for block, below in initial.items()]
    init += [f"(clear {block})" for block in names if block not in covered]
    goal = [_placed(block, below) for block, below in _towers(names, rng).items() if below is not None]
    objects = {"object": names}
    return BLOCKS, _problem(f"blocks-{num_blocks}-{seed}", "blocks", objects, [*init, "(hand-empty)"], goal)


def logistics(
    num_cities: int, num_locations: int, num_packages: int, num_airplanes: int = 1, seed: int = 0
) -> Texts:
    """Bring packages from city to city by truck and airplane; each city has an airport and a truck.

    `num_locations` counts those of one city, its airport included.
    """
    rng = np.random.default_rng(seed)
    cities, packages = _names("city", num_cities), _names("package", num_packages)
    airplanes = _names("airplane", num_airplanes)
    airports = [f"{city}-airport" for city in cities]
    others = {city: [f"{city}-{i}" for i in range(1, num_locations)] for city in cities}
    places = airports + [place for city in cities for place in others[city]]
    init = [
        f"(part-of {place} {city})"
        for airport, city in zip(airports, cities, strict=True)
        for place in (airport, *others[city])
    ]
    trucks = [f"{city}-truck" for city in cities]
    init += [f"(at {truck} {airport})" for truck, airport in zip(trucks, airports, strict=True)]
    init += [f"(at {airplane} {rng.choice(airports)})" for airplane in airplanes]
    init += [f"(at {package} {rng.choice(places)})" for package in packages]
    objects = {
        "city": cities,
        "airport": airports,
        "location": places[num_cities:],
        "truck": trucks,
        "airplane": airplanes,
        "package": packages,
    }
    goal = [f"(at {package} {rng.choice(places)})" for package in packages]
    name = f"logistics-{num_cities}-{num_locations}-{num_packages}-{num_airplanes}-{seed}"
    return LOGISTICS, _problem(name, "logistics", objects, init, goal)


def grid(
    width: int, height: int, num_marks: int, seed: int = 0, semantics: Semantics = "persistent"
) -> Texts:
    """Make a first-response map, as the joint problem that the robot plans for."""
    world = generate(np.random.default_rng(seed), height=height, width=width, num_marks=num_marks)
    problem = encode(world, semantics).composite
    return format_domain(problem.domain), format_problem(problem)


def _names(kind: str, count: int) -> list[str]:
    return [f"{kind}{i}" for i in range(1, count + 1)]


def _towers(names: list[str], rng: np.random.Generator) -> dict[str, str | None]:
    """Put each block, in random order, on a tower or on the table: what it stands on."""
    below: dict[str, str | None] = {}
    tops: list[str] = []
    for block in rng.permutation(names).tolist():
        choice = int(rng.integers(len(tops) + 1))
        below[block] = tops[choice] if choice < len(tops) else None
        tops[choice : choice + 1] = [block]
    return below


def _placed(block: str, below: str | None) -> str:
    return f"(on-table {block})" if below is None else f"(on {block} {below})"


def _problem(
    name: str, domain: str, objects: dict[str, list[str]], init: Iterable[str], goal: Iterable[str]
) -> str:
    listed = (" ".join(names) + (f" - {kind}" if kind != "object" else "") for kind, names in objects.items())
    return (
        f"(define (problem {name})\n  (:domain {domain})\n"
        f"  (:objects\n    {_lines(listed)})\n"
        f"  (:init\n    {_lines(init)})\n"
        f"  (:goal (and\n    {_lines(goal)})))\n"
    )


def _lines(parts: Iterable[str]) -> str:
    return "\n    ".join(parts)

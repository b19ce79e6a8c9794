"""A small team domain that is no grid: a nurse asks for things, a robot fetches them through a hospital.

The nurse does not know that one corridor is locked, and thinks another one is, which is open.
"""

from explicable.model.team import TeamProblem
from explicable.pddl import parse_domain, parse_problem

DOMAIN = """
(define (domain hospital)
  (:requirements :strips :typing :negative-preconditions)
  (:types robot human place item)
  (:predicates (in ?r - robot ?p - place) (corridor ?a ?b - place) (locked ?a ?b - place)
               (stored ?i - item ?p - place) (needed ?i - item) (asked ?i - item) (fetched ?i - item))
  (:action ask
    :parameters (?h - human ?i - item)
    :precondition (needed ?i)
    :effect (and (asked ?i) (not (needed ?i))))
  (:action go
    :parameters (?r - robot ?a ?b - place)
    :precondition (and (in ?r ?a) (corridor ?a ?b) (not (locked ?a ?b)))
    :effect (and (in ?r ?b) (not (in ?r ?a))))
  (:action fetch
    :parameters (?r - robot ?i - item ?p - place)
    :precondition (and (in ?r ?p) (stored ?i ?p) (asked ?i))
    :effect (and (fetched ?i) (not (asked ?i)))))
"""

PROBLEM = """
(define (problem night)
  (:domain hospital)
  (:objects robo - robot nurse - human hall ward lab store attic - place plaster syringe - item)
  (:init (in robo hall) (needed plaster) (needed syringe) (stored plaster store) (stored syringe attic)
         (corridor hall store) (corridor store hall) (corridor hall ward) (corridor ward hall)
         (corridor ward lab) (corridor lab ward) (corridor lab store) (corridor store lab)
         (corridor store attic) (corridor attic store) {locked})
  (:goal (and (fetched plaster) (fetched syringe))))
"""


def hospital(robot_domain: str = DOMAIN, extra: str = "") -> TeamProblem:
    """The nurse knows neither what the robot's own domain has beyond hers, nor the extra facts."""
    true, believed = "(locked hall store)", "(locked ward lab)"
    return TeamProblem(
        robot=parse_problem(PROBLEM.format(locked=true + extra), parse_domain(robot_domain)),
        human=parse_problem(PROBLEM.format(locked=believed), parse_domain(DOMAIN)),
    )

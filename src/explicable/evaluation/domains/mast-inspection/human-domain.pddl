; How the operator sees the drones: the same, but nobody told them that flying empties a battery.
(define (domain mast-inspection)
  (:requirements :strips :typing)
  (:types
    agent spot level - object
    drone - robot
    robot human - agent
    mast - spot)
  (:predicates
    (over ?d - drone ?s - spot)
    (lane ?from ?to - spot)
    (dock ?s - spot)
    (airborne ?d - drone)
    (grounded ?d - drone)
    (lens-clean ?d - drone)
    (asked ?m - mast)
    (inspected ?m - mast))

  (:action ask
    :parameters (?h - human ?m - mast)
    :precondition (and)
    :effect (asked ?m))

  (:action take-off
    :parameters (?d - drone ?s - spot)
    :precondition (and (over ?d ?s) (grounded ?d))
    :effect (and (airborne ?d) (not (grounded ?d))))

  (:action fly
    :parameters (?d - drone ?from ?to - spot ?before ?after - level)
    :precondition (and (airborne ?d) (over ?d ?from) (lane ?from ?to))
    :effect (and (over ?d ?to) (not (over ?d ?from))))

  (:action recharge
    :parameters (?d - drone ?s - spot ?before ?after - level)
    :precondition (over ?d ?s)
    :effect (and))

  (:action inspect
    :parameters (?d - drone ?m - mast)
    :precondition (and (airborne ?d) (over ?d ?m) (asked ?m) (lens-clean ?d))
    :effect (inspected ?m))

  (:action land
    :parameters (?d - drone ?s - spot)
    :precondition (and (over ?d ?s) (dock ?s) (airborne ?d))
    :effect (and (grounded ?d) (not (airborne ?d)))))

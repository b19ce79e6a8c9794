; Carts carry the parcels that a dispatcher orders. The carts' own model.
(define (domain warehouse)
  (:requirements :strips :typing :action-costs)
  (:types
    agent place parcel - object
    cart - robot
    robot human - agent)
  (:predicates
    (at ?c - cart ?p - place)
    (aisle ?from ?to - place)
    (passable ?from ?to - place)
    (stored ?x - parcel ?p - place)
    (destined ?x - parcel ?p - place)
    (ordered ?x - parcel)
    (empty ?c - cart)
    (carries ?c - cart ?x - parcel)
    (delivered ?x - parcel))
  (:functions
    (total-cost) - number
    (length ?from ?to - place) - number)

  (:action order
    :parameters (?h - human ?x - parcel)
    :precondition (and)
    :effect (and (ordered ?x) (increase (total-cost) 1)))

  (:action drive
    :parameters (?c - cart ?from ?to - place)
    :precondition (and (at ?c ?from) (aisle ?from ?to) (passable ?from ?to))
    :effect (and (at ?c ?to) (not (at ?c ?from)) (increase (total-cost) (length ?from ?to))))

  (:action load
    :parameters (?c - cart ?x - parcel ?p - place)
    :precondition (and (at ?c ?p) (stored ?x ?p) (empty ?c))
    :effect (and (carries ?c ?x) (not (stored ?x ?p)) (not (empty ?c)) (increase (total-cost) 1)))

  ; A cart may set a parcel down anywhere, for another cart to take over.
  (:action unload
    :parameters (?c - cart ?x - parcel ?p - place)
    :precondition (and (at ?c ?p) (carries ?c ?x))
    :effect (and (stored ?x ?p) (empty ?c) (not (carries ?c ?x)) (increase (total-cost) 1)))

  (:action hand-over
    :parameters (?c - cart ?x - parcel ?p - place)
    :precondition (and (at ?c ?p) (carries ?c ?x) (destined ?x ?p) (ordered ?x))
    :effect (and (delivered ?x) (empty ?c) (not (carries ?c ?x)) (increase (total-cost) 1))))

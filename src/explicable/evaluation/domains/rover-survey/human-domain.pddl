; How the scientist sees the rovers: the same, but nobody told them that an image fills the memory.
(define (domain rover-survey)
  (:requirements :strips :typing)
  (:types
    agent site target - object
    rover - robot
    robot human - agent
    view rock - target)
  (:predicates
    (at ?r - rover ?s - site)
    (path ?from ?to - site)
    (visible ?v - view ?from - site)
    (lies ?k - rock ?s - site)
    (antenna ?s - site)
    (camera-works ?r - rover)
    (requested ?t - target)
    (holds ?r - rover ?t - target)
    (received ?t - target))

  (:action request
    :parameters (?h - human ?t - target)
    :precondition (and)
    :effect (requested ?t))

  (:action drive
    :parameters (?r - rover ?from ?to - site)
    :precondition (and (at ?r ?from) (path ?from ?to))
    :effect (and (at ?r ?to) (not (at ?r ?from))))

  (:action photograph
    :parameters (?r - rover ?v - view ?s - site)
    :precondition (and (at ?r ?s) (visible ?v ?s) (requested ?v) (camera-works ?r))
    :effect (holds ?r ?v))

  (:action analyse
    :parameters (?r - rover ?k - rock ?s - site)
    :precondition (and (at ?r ?s) (lies ?k ?s) (requested ?k))
    :effect (holds ?r ?k))

  (:action send
    :parameters (?r - rover ?t - target ?s - site)
    :precondition (and (at ?r ?s) (antenna ?s) (holds ?r ?t))
    :effect (and (received ?t) (not (holds ?r ?t)))))

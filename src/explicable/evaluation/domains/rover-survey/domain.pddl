; Rovers survey what a scientist asks for. The robots' own model.
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
    (memory-free ?r - rover)
    (requested ?t - target)
    (holds ?r - rover ?t - target)
    (received ?t - target))

  ; The scientist may ask for anything at any time, also again.
  (:action request
    :parameters (?h - human ?t - target)
    :precondition (and)
    :effect (requested ?t))

  (:action drive
    :parameters (?r - rover ?from ?to - site)
    :precondition (and (at ?r ?from) (path ?from ?to))
    :effect (and (at ?r ?to) (not (at ?r ?from))))

  ; An image fills the memory until it has been sent.
  (:action photograph
    :parameters (?r - rover ?v - view ?s - site)
    :precondition (and (at ?r ?s) (visible ?v ?s) (requested ?v) (camera-works ?r) (memory-free ?r))
    :effect (and (holds ?r ?v) (not (memory-free ?r))))

  (:action analyse
    :parameters (?r - rover ?k - rock ?s - site)
    :precondition (and (at ?r ?s) (lies ?k ?s) (requested ?k) (memory-free ?r))
    :effect (and (holds ?r ?k) (not (memory-free ?r))))

  (:action send
    :parameters (?r - rover ?t - target ?s - site)
    :precondition (and (at ?r ?s) (antenna ?s) (holds ?r ?t))
    :effect (and (received ?t) (memory-free ?r) (not (holds ?r ?t)))))

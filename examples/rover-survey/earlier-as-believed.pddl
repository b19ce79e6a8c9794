; The earlier survey as the scientist saw it: both cameras work.
(define (problem earlier-as-believed)
  (:domain rover-survey)
  (:objects
    scientist - human
    scout hauler - rover
    lander ridge dune crater gully plain mesa - site
    dune-crest crater-floor - view
    granite chalk - rock)
  (:init
    (at scout dune) (at hauler plain)
    (path lander ridge) (path ridge lander)
    (path ridge crater) (path crater ridge)
    (path ridge dune) (path dune ridge)
    (path lander plain) (path plain lander)
    (path plain gully) (path gully plain)
    (path plain mesa) (path mesa plain)
    (path dune gully) (path gully dune)
    (path gully mesa) (path mesa gully)
    (antenna lander) (antenna mesa)
    (visible dune-crest dune) (visible dune-crest ridge) (visible crater-floor crater)
    (lies granite gully) (lies chalk ridge)
    (camera-works scout) (camera-works hauler))
  (:goal (and (received dune-crest) (received crater-floor) (received granite) (received chalk))))

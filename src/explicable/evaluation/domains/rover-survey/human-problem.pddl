; What the scientist believes: both cameras work.
(define (problem survey-as-believed)
  (:domain rover-survey)
  (:objects
    scientist - human
    scout hauler - rover
    lander ridge dune crater gully plain mesa - site
    crater-wall gully-bed summit - view
    basalt shale - rock)
  (:init
    (at scout ridge) (at hauler lander)
    (path lander ridge) (path ridge lander)
    (path ridge crater) (path crater ridge)
    (path ridge dune) (path dune ridge)
    (path lander plain) (path plain lander)
    (path plain gully) (path gully plain)
    (path plain mesa) (path mesa plain)
    (path dune gully) (path gully dune)
    (path gully mesa) (path mesa gully)
    (antenna lander) (antenna mesa)
    (visible crater-wall crater) (visible gully-bed gully) (visible summit mesa) (visible summit dune)
    (lies basalt crater) (lies shale plain)
    (camera-works scout) (camera-works hauler))
  (:goal (and
    (received crater-wall) (received gully-bed) (received summit)
    (received basalt) (received shale))))

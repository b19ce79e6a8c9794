; As the operator sees it: the lane between m4 and m5 is free, and both lenses are clean.
(define (problem five-masts)
  (:domain mast-inspection)
  (:objects
    operator - human
    alba brio - drone
    north south - spot
    m1 m2 m3 m4 m5 - mast
    l0 l1 l2 - level)
  (:init
    (over alba north) (grounded alba)
    (over brio south) (grounded brio)
    (dock north) (dock south)
    (lens-clean alba) (lens-clean brio)
    (lane north m1) (lane m1 north)
    (lane m1 m2) (lane m2 m1)
    (lane m2 south) (lane south m2)
    (lane north m3) (lane m3 north)
    (lane m3 m4) (lane m4 m3)
    (lane m4 m2) (lane m2 m4)
    (lane m5 south) (lane south m5)
    (lane m4 m5) (lane m5 m4))
  (:goal (and (inspected m1) (inspected m2) (inspected m3) (inspected m4) (inspected m5) (grounded alba) (grounded brio))))

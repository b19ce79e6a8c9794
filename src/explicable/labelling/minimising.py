"""Smooth functions minimised by L-BFGS-B of SciPy (Byrd et al. 1995), deterministically."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

Objective: TypeAlias = Callable[[NDArray[np.float64]], tuple[float, NDArray[np.float64]]]
"""A function that returns its value and its gradient."""


@dataclass(frozen=True, slots=True)
class Optimum:
    """Where the minimiser stopped.

    Attributes
    ----------
    weights
        The variables; of a training problem the state weights (features x labels, flat), then the transition
        weights.
    objective
        The function's value there; of a training problem the penalised loss.
    num_iterations
        Iterations of L-BFGS.
    converged
        Whether it stopped because it could not improve any more.
    """

    weights: NDArray[np.float64]
    objective: float
    num_iterations: int
    converged: bool


def minimise(
    objective: Objective,
    start: NDArray[np.float64],
    *,
    lowest: float = -math.inf,
    max_iterations: int = 1000,
    tolerance: float = 1e-10,
) -> Optimum:
    """Minimise a smooth function by L-BFGS-B, deterministically.

    Parameters
    ----------
    objective
        Returns value and gradient.
    start
        Where to begin.
    lowest
        Lower bound of every variable.
    max_iterations, tolerance
        When to stop: after so many iterations, or when one improves the value by less than this fraction.

    Examples
    --------
    >>> minimise(lambda x: (float((x - 3) @ (x - 3)), 2 * (x - 3)), np.zeros(2)).weights.round(6).tolist()
    [3.0, 3.0]
    """
    from scipy.optimize import Bounds, minimize

    if len(start) == 0:
        return Optimum(start, objective(start)[0], 0, True)
    # One thread: L-BFGS works on vectors far too short to share, and sums must not depend on the machine.
    with _linear_algebra().limit(limits=1, user_api="blas"):
        result = minimize(
            objective,
            start,
            jac=True,
            method="L-BFGS-B",
            bounds=Bounds(np.full(len(start), lowest)) if lowest > -math.inf else None,
            options={
                "maxiter": max_iterations,
                "maxfun": 2 * max_iterations + 20,
                "ftol": tolerance,
                "gtol": 0.0,
            },
        )
    # Status 2: no step improves the objective any more; floating point allows no better.
    return Optimum(result.x, float(result.fun), int(result.nit), result.status in {0, 2})


@cache
def _linear_algebra() -> "ThreadpoolController":
    """Return what holds the threads of linear algebra, once SciPy has loaded it.

    Which libraries there are takes as long to find out as to adapt a labeller to one person.
    """
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()

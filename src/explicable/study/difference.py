"""The difference of two shares, seen by people who each answer several times: its size and its test."""

import numpy as np
from numpy.typing import NDArray

LEVEL = 0.05
"""Share of studies that may find a difference where there is none; two-sided."""

_Array = NDArray[np.float64]


def find_differences(studies: _Array) -> tuple[_Array, NDArray[np.bool_]]:
    """Return the difference that each study sees, and whether it is significant.

    Parameters
    ----------
    studies
        Of shape (studies, people, 2, 2): for each person and each of the two compared, robot steps called
        explicable, and robot steps labelled.

    Notes
    -----
    The difference of two pooled shares, with the sandwich estimate of its error: what a generalised
    estimating equation with the identity link and independent working correlation says of answers clustered
    by person (Liang & Zeger, Biometrika 73, 1986). Because people may be few, its variance is multiplied by
    n / (n - 1), and the quotient is held against Student's t with n - 1 degrees of freedom.

    Examples
    --------
    >>> one, other = [9, 8, 9, 7], [2, 4, 3, 3]
    >>> study = np.array([[(yes, 10), (no, 10)] for yes, no in zip(one, other)], float)
    >>> difference, is_significant = find_differences(study[None])
    >>> round(float(difference[0]), 3), bool(is_significant[0])
    (0.525, True)
    """
    from scipy.stats import t

    num_people = studies.shape[1]
    total = studies.sum(axis=1)
    asked = np.maximum(total[..., 1], 1)  # nobody has seen one of the two: no difference is seen
    shares = total[..., 0] / asked
    off = (studies[..., 0] - shares[:, None] * studies[..., 1]) / asked[:, None]
    error = np.sqrt(((off[..., 0] - off[..., 1]) ** 2).sum(axis=1) * num_people / (num_people - 1))
    difference = np.where((total[..., 1] > 0).all(axis=1), shares[:, 0] - shares[:, 1], 0.0)
    return difference, np.abs(difference) > t.ppf(1 - LEVEL / 2, num_people - 1) * error


def wilson(share: float, num: int) -> tuple[float, float]:
    """Return middle and half width of the 95 % interval of a share (Wilson, J. Am. Stat. Assoc. 22, 1927)."""
    z = 1.959964
    scale = 1 + z * z / num
    middle = (share + z * z / (2 * num)) / scale
    return middle, z / scale * float(np.sqrt(share * (1 - share) / num + z * z / (4 * num * num)))

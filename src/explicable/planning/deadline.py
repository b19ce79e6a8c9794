"""A time limit that several searches share."""

import math
import time
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Deadline:
    """The moment by which all must be done.

    Parameters
    ----------
    moment_s
        Reading of `time.monotonic`; infinite where there is no limit.
    """

    moment_s: float = math.inf

    @classmethod
    def after(cls, limit_s: float | None) -> "Deadline":
        """Return the deadline in so many seconds from now; None: there is none.

        Examples
        --------
        >>> Deadline.after(None).left_s, Deadline.after(0.0).left_s
        (inf, 0.0)
        """
        return cls() if limit_s is None else cls(time.monotonic() + limit_s)

    @property
    def left_s(self) -> float:
        """Seconds left, at least 0."""
        return max(0.0, self.moment_s - time.monotonic())

    @property
    def limit_s(self) -> float | None:
        """The same as searches take it: None without limit."""
        return None if self.moment_s == math.inf else self.left_s


NEVER = Deadline()
"""No limit of time."""

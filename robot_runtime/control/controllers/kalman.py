"""The measurement update of a Kalman filter with any state."""

from collections.abc import Sequence
from operator import mul

Matrix = list[list[float]]


def dot(one: Sequence[float], other: Sequence[float]) -> float:
    """Of two vectors of one length."""
    return sum(map(mul, one, other), start=0.0)


def take_in(covariance: Matrix, row: Sequence[float], variance: float) -> tuple[list[float], Matrix]:
    """A scalar measurement of `row` times the state, of this variance: gains, and the covariance after it.

    The state gains each gain times what was measured more than expected (A. Gelb, Applied Optimal
    Estimation, 1974, table 4.2-1).
    """
    towards = [dot(line, row) for line in covariance]
    total = dot(towards, row) + variance
    gains = [one / total for one in towards]
    after = [
        [old - gain * one for old, one in zip(line, towards, strict=True)]
        for line, gain in zip(covariance, gains, strict=True)
    ]
    return gains, after

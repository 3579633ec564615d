"""A signal over time, as arrays, and its tracking error and effort."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Series:
    """A signal's samples in the order of time: s since the session's start, and the unit of the signal."""

    times: Floats
    values: Floats

    def within(self, start: float, end: float) -> "Series":
        """Return the samples between these times."""
        first = int(np.searchsorted(self.times, start, "left"))
        last = int(np.searchsorted(self.times, end, "right"))
        return Series(self.times[first:last], self.values[first:last])

    @property
    def bytes(self) -> int:
        """The memory of the arrays, in bytes."""
        return self.times.nbytes + self.values.nbytes


def rms(errors: Floats) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(errors**2)))


def integral_absolute(times: Floats, errors: Floats) -> float:
    """Return the integral of the absolute error over time (s), by the trapezoidal rule."""
    return float(np.trapezoid(np.abs(errors), times))


def effort(outputs: Floats) -> float:
    """Return the mean size of the command, as a share of the most."""
    return float(np.mean(np.abs(outputs)))


def travel(outputs: Floats) -> float:
    """Return the sum of the command's changes, as a share of full command."""
    return float(np.abs(np.diff(outputs)).sum())

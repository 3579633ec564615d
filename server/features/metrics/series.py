"""A signal over time, as arrays."""

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
        """The samples between these times."""
        first = int(np.searchsorted(self.times, start, "left"))
        last = int(np.searchsorted(self.times, end, "right"))
        return Series(self.times[first:last], self.values[first:last])

    @property
    def bytes(self) -> int:
        """Memory that it takes."""
        return self.times.nbytes + self.values.nbytes

"""Line faults of a test, in both directions: rates for each bit or byte, and timed stalls and cuts.

Everything follows from one seed.
"""

import heapq
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, Protocol

RateKind = Literal["bit_errors", "drop", "double", "insert"]
RATE_KINDS: tuple[RateKind, ...] = ("bit_errors", "drop", "double", "insert")
Moment = tuple[float, Literal["stall", "cut", "mend"], float]
"""When (s of the test), what, and for how long (s)."""


class LineFaultInjector(Protocol):
    """Injects faults into a line, in both directions."""

    def seed(self, seed: int) -> None:
        """Seeds all faults from now on."""

    def rate(self, kind: RateKind, rate: float) -> None:
        """Sets the probability of this fault for each bit or byte."""

    def burst(self, rate: float, bits: int) -> None:
        """Sets the probability that a burst of errors begins at a bit, and its length in bit times."""

    def stall(self, seconds: float) -> None:
        """Delays all bytes for this many s."""

    def cut(self, cut: bool) -> None:
        """Cuts the line, or restores it."""

    def clean(self) -> None:
        """Removes all faults."""


@dataclass(frozen=True, slots=True)
class Faults:
    """Rates from 0 to 1; `burst` is a rate and a length in bits; `stall` and `cut` come every so many s, for
    so many s.
    """

    seed: int = 0
    bit_errors: float = 0.0
    drop: float = 0.0
    double: float = 0.0
    insert: float = 0.0
    burst: tuple[float, int] | None = None
    stall: tuple[float, float] | None = None
    cut: tuple[float, float] | None = None

    def begin(self, wire: LineFaultInjector) -> None:
        """Starts the faults that have rates; `moments` gives the others."""
        wire.seed(self.seed)
        for kind in RATE_KINDS:
            if rate := getattr(self, kind):
                wire.rate(kind, rate)
        if self.burst:
            wire.burst(*self.burst)

    def moments(self, start: float) -> Iterator[Moment]:
        """Yields the timed faults in order, without end; `start` is when the faults began (s of the test)."""
        streams = []
        if self.stall:
            streams.append(_every(start, *self.stall, "stall"))
        if self.cut:
            streams += [_every(start, *self.cut, "cut"), _every(start + self.cut[1], *self.cut, "mend")]
        return heapq.merge(*streams)


def _every(
    start: float, period: float, seconds: float, kind: Literal["stall", "cut", "mend"]
) -> Iterator[Moment]:
    number = 0
    while True:
        number += 1
        yield start + number * period, kind, seconds

"""What a test lets befall the line, in both directions: rates for every bit or byte, and what comes again and
again in the test's time. Everything follows from one seed.
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
    """A line that can be harmed, both directions at once."""

    def seed(self, seed: int) -> None:
        """Let everything from now on follow from this number."""

    def rate(self, kind: RateKind, rate: float) -> None:
        """Let this happen to each bit or byte with this probability."""

    def burst(self, rate: float, bits: int) -> None:
        """Let bursts of errors begin at each bit with this probability, and last so many bit times."""

    def stall(self, seconds: float) -> None:
        """Hold everything back for this long."""

    def cut(self, cut: bool) -> None:
        """Break the line, or mend it."""

    def clean(self) -> None:
        """End everything."""


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
        """Let them begin, but for those that `moments` tells of."""
        wire.seed(self.seed)
        for kind in RATE_KINDS:
            if rate := getattr(self, kind):
                wire.rate(kind, rate)
        if self.burst:
            wire.burst(*self.burst)

    def moments(self, start: float) -> Iterator[Moment]:
        """What comes at its time, in order, for ever; `start` is when the faults began (s of the test)."""
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

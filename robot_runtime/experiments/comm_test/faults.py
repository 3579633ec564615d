"""Line faults of a test, in both directions: rates for each bit or byte, and timed stalls and cuts.

All faults follow from one seed.
"""

import heapq
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Annotated, Literal

from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.experiments.line_faults.faults import DIRECTIONS, KINDS

TimedKind = Literal["stall", "cut", "mend"]
TimedFault = tuple[float, TimedKind, float]
"""Its time (s of the test), its kind, and how long it lasts (s)."""
Order = Callable[[str], object]
"""Gives a line one of the emulated board's commands for faults; see docs/reference/emulator.md."""
FaultRate = Annotated[float, Range(0, 0.1)]
Recurring = tuple[Annotated[float, Range(0.05, 3600)], float]
"""The period and the duration, both in s."""


@dataclass(frozen=True, slots=True)
class Faults:
    """Rates for each bit or byte; `burst` is a rate and a length in bits; `stall` and `cut` recur."""

    seed: Annotated[int, Range(0, 2**32 - 1)] = 0
    bit_errors: FaultRate = 0.0
    drop: FaultRate = 0.0
    double: FaultRate = 0.0
    insert: FaultRate = 0.0
    burst: tuple[FaultRate, Annotated[int, Range(1, 10_000)]] | None = None
    stall: Recurring | None = None
    cut: Recurring | None = None

    def __post_init__(self) -> None:
        problems = [
            DocumentEntry(name, (name,))
            .item(1)
            .problem(f"is {times[1]:g}; it must be above 0 and below the period, {times[0]:g} s")
            for name, times in (("stall", self.stall), ("cut", self.cut))
            if times is not None and not 0 < times[1] < times[0]
        ]
        if problems:
            raise ConfigError(*problems)

    def begin(self, order: Order) -> None:
        """Start the faults that have rates; `timed` gives the others."""
        order(f"seed {self.seed}")
        for kind in KINDS:
            if rate := getattr(self, kind):
                order_both(order, f"{kind} {rate!r}")
        if self.burst:
            order_both(order, f"burst {self.burst[0]!r} {self.burst[1]}")

    def timed(self, start: float) -> Iterator[TimedFault]:
        """Yield the timed faults in order, without end; `start` is when the faults began (s of the test)."""
        streams = []
        if self.stall:
            streams.append(_repeat(start, *self.stall, "stall"))
        if self.cut:
            streams += [_repeat(start, *self.cut, "cut"), _repeat(start + self.cut[1], *self.cut, "mend")]
        return heapq.merge(*streams)


def order_both(order: Order, fault: str) -> None:
    """Give the command `line` with this fault for both directions."""
    for direction in DIRECTIONS:
        order(f"line {direction} {fault}")


def _repeat(start: float, period: float, seconds: float, kind: TimedKind) -> Iterator[TimedFault]:
    number = 0
    while True:
        number += 1
        yield start + number * period, kind, seconds

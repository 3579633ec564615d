"""Times of the control ticks in phase with the board's depths.

The board takes a depth every `depth_period`. A tick is due `MARGIN` after one has arrived, so that it acts on
a sample that is some milliseconds old, and on all that came since the last tick. Bytes that waited for a tick
do not say when they came. So now and then a tick begins early, and waits for its depth; by that one's arrival
the following ticks are moved, and so is their period, since the board's clock differs.
"""

from robot_runtime.periodic_task import SAME_TIME

MARGIN = 0.002
"""s between a depth's arrival and the tick that uses it."""
EARLY = 0.008
"""s by which a tick begins early that waits for its depth."""
WAIT_EVERY = 5
"""Ticks from one that waits to the next: twice a second at 10 Hz, and so in each second over which the link
measures the least delay of what comes."""
SETTLING = 10
"""Ticks that all wait while the phase is looked for."""
MISSED_MAX = 3
"""Depths in a row that may come too early or too late to be seen; then the phase is looked for again."""
_PHASE_GAIN, _DRIFT_GAIN = 0.7, 0.3
_DRIFT_MAX = 0.01
"""Share by which the clocks may differ: ceramic resonators are within half of it."""


class PhaseLock:
    """The times of ticks every `period` (s), first at `start`, for depths every `depth_period` (s)."""

    def __init__(self, start: float, period: float, depth_period: float) -> None:
        self._tick_at = start
        self._period = period
        self._depth_period = depth_period
        self._drift = 0.0
        self._waiting = SETTLING
        """Arrivals that are still to be seen until it is settled."""
        self._since = self._missed = 0
        """Ticks since the last arrival, and those of them that waited for one."""

    @property
    def waits(self) -> bool:
        """True if the next tick begins early, and waits for its depth."""
        return self._waiting > 0 or self._since % WAIT_EVERY == 0

    @property
    def due(self) -> float:
        """The time at which the next tick begins, s."""
        return self._tick_at - (EARLY if self.waits else 0.0)

    @property
    def patience(self) -> float:
        """The longest time, s, for which a tick waits for its depth: one that began late has it already."""
        return EARLY + (self._depth_period if self._waiting == SETTLING else MARGIN)

    def advance(self, now: float, arrived: float | None) -> None:
        """Set the next tick's time after one that ends at `now`; a depth waited for `arrived` then (s)."""
        if arrived is not None:
            self._see(arrived)
        elif self.waits:
            self._missed += 1
            if self._missed == MISSED_MAX:
                self._waiting = SETTLING
        self._since += 1
        self._tick_at += self._period * (1 + self._drift)
        if self._tick_at <= now + SAME_TIME:
            # A missed tick is not made up for.
            self._tick_at = now + self._period

    def _see(self, arrived: float) -> None:
        off = (arrived + MARGIN - self._tick_at) % self._depth_period
        off -= self._depth_period if off > self._depth_period / 2 else 0.0
        if self._waiting == SETTLING:
            self._tick_at += off
        else:
            self._tick_at += _PHASE_GAIN * off
            drift = self._drift + _DRIFT_GAIN * off / (self._since * self._period)
            self._drift = min(max(drift, -_DRIFT_MAX), _DRIFT_MAX)
        self._waiting = max(self._waiting - 1, 0)
        self._since = self._missed = 0

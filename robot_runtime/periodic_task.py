"""An action at a fixed rate, by a clock that the caller reads."""

from collections.abc import Callable

SAME_TIME = 1e-6
"""Moments closer than this (s) are one moment: sums of periods are not exact."""


class PeriodicTask:
    """An action every `period` (s), first at `start`. A missed period is not made up for."""

    def __init__(self, start: float, period: float, action: Callable[[], object]) -> None:
        self.due = start
        self._period = period
        self._action = action

    def run_if_due(self, now: float) -> None:
        """Run the action if it is due."""
        if now < self.due - SAME_TIME:
            return
        self.due += self._period
        if self.due <= now:
            self.due = now + self._period
        self._action()

"""When the next picture is due."""

from robot_runtime.clock import Clock

RATE_MIN = 0.2
RATE_MAX = 30.0


class Pace:
    """An even rhythm of `rate` Hz, which may change at any time. What came late is not made up for."""

    def __init__(self, clock: Clock, rate: float) -> None:
        self._clock = clock
        self.rate = rate
        self._last = clock.now() - 1 / self.rate

    @property
    def rate(self) -> float:
        """Hz. Raises ValueError when it is set below 0.2 or above 30."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        if not RATE_MIN <= rate <= RATE_MAX:
            raise ValueError(f"a vision rate of {rate} Hz is not between {RATE_MIN:g} and {RATE_MAX:g} Hz")
        self._rate = rate

    def remaining(self) -> float:
        """Seconds until the next one is due; 0 or less when it is."""
        return self._last + 1 / self._rate - self._clock.now()

    def begin(self) -> None:
        """Note that the one that was due begins now."""
        period, now = 1 / self._rate, self._clock.now()
        self._last = self._last + period if now < self._last + 2 * period else now

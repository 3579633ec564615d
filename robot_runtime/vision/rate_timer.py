"""When the next picture is due."""

from robot_runtime.clock import Clock
from robot_runtime.contract.limits import VISION_RATE


class RateTimer:
    """An even rhythm of `rate` Hz, which may change at any time. What came late is not made up for."""

    def __init__(self, clock: Clock, rate: float) -> None:
        self._clock = clock
        self.rate = rate
        self._last = clock.now() - 1 / self.rate

    @property
    def rate(self) -> float:
        """Hz. Raises ValueError when it is set to what is not in VISION_RATE."""
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        low, high = VISION_RATE.minimum, VISION_RATE.maximum
        if not low <= rate <= high:
            raise ValueError(f"a vision rate of {rate} Hz is not between {low:g} and {high:g} Hz")
        self._rate = rate

    def remaining(self) -> float:
        """Seconds until the next one is due; 0 or less when it is."""
        return self._last + 1 / self._rate - self._clock.now()

    def begin(self) -> None:
        """Note that the one that was due begins now."""
        period, now = 1 / self._rate, self._clock.now()
        self._last = self._last + period if now < self._last + 2 * period else now

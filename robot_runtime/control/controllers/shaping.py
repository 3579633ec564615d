"""The rate of a measured value, and the speed that braking allows."""

from math import copysign, sqrt


class Rate:
    """The rate of change of a value, low-pass filtered; 0 until two values were seen."""

    def __init__(self, time_constant: float) -> None:
        self.value = 0.0
        self._time_constant = time_constant
        self._last: float | None = None

    def see(self, measured: float, seconds: float) -> None:
        """The value is this, `seconds` after the one before."""
        if self._last is not None and seconds > 0:
            rate = (measured - self._last) / seconds
            self.value += (rate - self.value) * seconds / (self._time_constant + seconds)
        self._last = measured


def braked(left: float, braking: float, slope: float) -> float:
    """The speed that braking allows with so much left: √(2·a·left), linear where that is too steep.

    A boundary layer: J.-J. Slotine and W. Li, Applied Nonlinear Control, 1991, 7.2.
    """
    linear = braking / slope**2
    if abs(left) <= linear:
        return slope * left
    return copysign(sqrt(2 * braking * (abs(left) - linear / 2)), left)

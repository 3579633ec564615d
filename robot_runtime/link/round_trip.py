"""The time from sending a frame to its acknowledgement, and how long to wait for that.

RFC 6298 (Jacobson, 1988): a smoothed mean and a smoothed deviation, and a timeout of the mean plus four times
the deviation. Two things differ, for a line that nobody shares. The wait is capped and never doubled: losses
here are noise and not congestion, and waiting longer does not make them rarer. And the time that the bytes in
flight need on the line is added on top. By Karn's rule only frames that were sent once are measured.
"""

_CAP = 0.1
_MEAN_GAIN = 1 / 8
_DEVIATION_GAIN = 1 / 4


class RoundTrip:
    """Estimates, in s; 0 before the first measurement."""

    def __init__(self) -> None:
        self.mean = 0.0
        self.deviation = 0.0
        self._measured = False

    def measure(self, seconds: float) -> None:
        """Take in the round trip of one frame that was sent once."""
        if not self._measured:
            self._measured = True
            self.mean, self.deviation = seconds, seconds / 2
            return
        self.deviation += _DEVIATION_GAIN * (abs(self.mean - seconds) - self.deviation)
        self.mean += _MEAN_GAIN * (seconds - self.mean)

    def timeout(self, airtime: float) -> float:
        """s to wait for an acknowledgement while bytes that take this long are in flight."""
        wait = self.mean + 4 * self.deviation if self._measured else _CAP
        return min(wait, _CAP) + airtime

"""The time from sending a frame to its acknowledgement, and how long to wait for that.

RFC 6298 (Jacobson, 1988): a smoothed mean and a smoothed deviation, and a timeout of the mean plus four times
the deviation. Two things differ, for a line that nobody shares. The wait is capped and never doubled: losses
here are noise and not congestion, and waiting longer does not make them rarer. The cap is 0.1 s and the
airtime of two of the other end's longest frames: the one that is under way when ours arrives, and the one
after it that acknowledges ours. And the time that the bytes in flight need on the line is added on top. By
Karn's rule only frames are measured of which one copy alone can have arrived.
"""

from robot_runtime.link.timing import frames_airtime

_CAP = 0.1
_MEAN_GAIN = 1 / 8
_DEVIATION_GAIN = 1 / 4


class RoundTrip:
    """Estimates for a line of this many baud, in s; 0 before the first measurement."""

    def __init__(self, baud: int) -> None:
        self.mean = 0.0
        self.deviation = 0.0
        self._measured = False
        self._cap = _CAP + frames_airtime(2, baud)

    def measure(self, seconds: float) -> None:
        """Update the estimates by the round trip of one frame."""
        if not self._measured:
            self._measured = True
            self.mean, self.deviation = seconds, seconds / 2
            return
        self.deviation += _DEVIATION_GAIN * (abs(self.mean - seconds) - self.deviation)
        self.mean += _MEAN_GAIN * (seconds - self.mean)

    def timeout(self, airtime: float) -> float:
        """Return the time (s) to wait for an acknowledgement while bytes of this airtime are in flight."""
        wait = self.mean + 4 * self.deviation if self._measured else self._cap
        return min(wait, self._cap) + airtime

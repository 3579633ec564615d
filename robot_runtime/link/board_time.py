"""The board's clock in terms of the host's.

A packet arrives later than it was stamped, never earlier. So of each second only the packet that was delayed
least counts, and a straight line through the last of these gives the clocks' offset and their drift. A
second in which everything was late lies off that line, and is left out of a second, final fit. Where a whole
second lies off by more than any delay, the board's clock has paused: what was known is forgotten. No packet
is ever said to have been stamped after it arrived.

A stamp wraps after 71 minutes. Telemetry is sent when it is stamped, so that its arrival tells which stamp it
is, after a silence of any length. A reliable message may have waited for a host: its stamp is only mapped, as
the newest one before its arrival.
"""

from collections import deque
from math import sqrt

_WRAP = 1 << 32
_WINDOW = 1.0  # s
_WINDOWS = 30
_WINDOWS_FOR_DRIFT = 4
_JUMP = 0.01  # s
_OUTLIER = 2.0  # standard deviations
_RESOLUTION = 1e-6  # s, of a stamp
_AHEAD = 60_000_000  # µs by which a message may be newer than the arrival of telemetry shows; a stalled host


class BoardTime:
    """The map of one boot's stamps (µs, 32 bits, wrapping) to host seconds."""

    def __init__(self) -> None:
        self.drift = 0.0
        """By how much the board's clock is slow, as a share."""
        self.error = 0.0
        """Standard deviation of the fit, s; 0 until there is one."""
        self._unwrapped: int | None = None
        self._arrival = 0.0
        self._least: deque[tuple[float, float]] = deque(maxlen=_WINDOWS)
        self._middle = 0.0
        self._offset: float | None = None
        self._window_ends = float("-inf")
        self._window_least: tuple[float, float] | None = None

    def to_host(self, stamp: int, arrival: float) -> float:
        """Return the host time, s, at which the board stamped telemetry that arrived at `arrival` (s)."""
        # Stamps of one frame may lie a little before the last one seen.
        self._unwrapped = self._unwrap(stamp, arrival, _WRAP // 2)
        self._arrival = arrival
        board = self._unwrapped * 1e-6
        if arrival >= self._window_ends:
            self._close_window()
            self._window_ends = arrival + _WINDOW
        if self._window_least is None or arrival - board < self._window_least[1] + self._slope(board):
            self._window_least = board, arrival - board
        return self._mapped(board, self._window_least)

    def to_host_waiting(self, stamp: int, arrival: float) -> float:
        """Return the host time, s, at which the board stamped a message that may have waited to be sent.

        It leaves the clock as it is. Before any telemetry nothing but the arrival is known.
        """
        if self._window_least is None:
            return arrival
        board = self._unwrap(stamp, arrival, _AHEAD) * 1e-6
        return min(self._mapped(board, self._window_least), arrival)

    def _unwrap(self, stamp: int, arrival: float, ahead: int) -> int:
        """Return this stamp's newest time (µs) that is at most `ahead` µs later than the arrival shows."""
        if self._unwrapped is None:
            return stamp
        latest = self._unwrapped + round((arrival - self._arrival) * 1e6) + ahead
        return latest - (latest - stamp) % _WRAP

    def _mapped(self, board: float, least: tuple[float, float]) -> float:
        if self._offset is None:
            return board + least[1]
        # Less delayed than anything the line was drawn through: it shows the line to be late.
        early = min(least[1] - self._fitted(least[0]), 0.0)
        return board + self._fitted(board) + early

    def _slope(self, board: float) -> float:
        """Return the drift between the window's least delayed packet and this one."""
        return self.drift * (board - self._window_least[0]) if self._window_least else 0.0

    def _fitted(self, board: float) -> float:
        return (self._offset or 0.0) + self.drift * (board - self._middle)

    def _close_window(self) -> None:
        if self._window_least is None:
            return
        board, offset = self._window_least
        self._window_least = None
        if self._offset is not None and abs(offset - self._fitted(board)) > _JUMP:
            self._least.clear()
        self._least.append((board, offset))
        self._fit(list(self._least))
        inliers = [
            point
            for point in self._least
            if abs(point[1] - self._fitted(point[0])) <= _OUTLIER * self.error + _RESOLUTION
        ]
        self._fit(inliers)

    def _fit(self, points: list[tuple[float, float]]) -> None:
        """Fit by least squares, about the points' middle so that little is lost to rounding."""
        count = len(points)
        self._middle = sum(board for board, _ in points) / count
        mean = sum(offset for _, offset in points) / count
        spread = sum((board - self._middle) ** 2 for board, _ in points)
        products = sum((board - self._middle) * (offset - mean) for board, offset in points)
        self.drift = products / spread if count >= _WINDOWS_FOR_DRIFT and spread > 0 else 0.0
        self._offset = mean
        self.error = sqrt(sum((offset - self._fitted(board)) ** 2 for board, offset in points) / count)

"""The pose of the robot from several topics, ten times a second, in our own axes."""

from collections.abc import Sequence
from math import isfinite

from robot_runtime.contract.documents import Truth
from robot_runtime.contract.packets import Depth, Imu
from server.features.doors.channels import Sample
from server.features.exports.pose import PERIOD_NS

SOURCES = ("truth", "depth", "imu")


class PoseTracker:
    """The newest position with each attitude that is due.

    The position is the simulated body's where there is one. A real robot knows its depth alone: north and
    east are 0.
    """

    def __init__(self) -> None:
        self._position: Sequence[float] | None = None
        self._true = False
        self._last = -PERIOD_NS

    def see(self, sample: Sample) -> tuple[Sequence[float], Sequence[float]] | None:
        """Process a sample; position (m, north, east, down) and attitude (w, x, y, z) when they are due."""
        value = sample.value
        if isinstance(value, Truth):
            self._position, self._true = value.position, True
        elif isinstance(value, Depth) and not self._true:
            self._position = (0.0, 0.0, value.depth)
        elif isinstance(value, Imu) and self._position is not None and self._is_due(sample.time):
            if not all(map(isfinite, (*self._position, *value.attitude))):
                return None
            self._last = sample.time
            return self._position, value.attitude
        return None

    def _is_due(self, time: int) -> bool:
        # Time goes back where the computer's clock is set.
        return not 0 <= time - self._last < PERIOD_NS

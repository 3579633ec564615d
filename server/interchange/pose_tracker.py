"""The robot's pose from the samples of several topics, ten times a second, in our own axes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

from robot_runtime.contract import topics

PERIOD_NS = 100_000_000
"""Time between two poses; 3-D panels interpolate."""
POSE_TOPICS = (topics.TRUTH.name, topics.DEPTH.name, topics.IMU.name)

ReadField = Callable[[str], Any]
"""Returns a sample's field of this name; None where it has none."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Position (m: north, east, down) and attitude (w, x, y, z)."""

    position: Sequence[float]
    attitude: Sequence[float]


class PoseTracker:
    """Combines the newest position with each attitude that is due.

    The position is the simulated body's where there is one. A real robot knows its depth alone: north and
    east are 0. `attitude` is the topic of the attitude.
    """

    def __init__(self, attitude: str = topics.IMU.name) -> None:
        self._attitude = attitude
        self._position: ReadField | None = None
        self._position_is_true = False
        self._last = -PERIOD_NS

    def see(self, topic: str, time: int, field: ReadField) -> Pose | None:
        """Process a sample of `time` (ns, UTC); return the pose when it is due and known."""
        if topic == topics.TRUTH.name:
            self._position, self._position_is_true = field, True
        elif topic == topics.DEPTH.name and not self._position_is_true:
            self._position = field
        if topic != self._attitude or self._position is None or not self._is_due(time):
            return None
        position = (
            self._position("position") if self._position_is_true else (0.0, 0.0, self._position("depth"))
        )
        pose = Pose(position, field("attitude"))
        if any(value is None or not isfinite(value) for value in (*pose.position, *pose.attitude)):
            return None
        self._last = time
        return pose

    def _is_due(self, time: int) -> bool:
        # Time goes back where the computer's clock is set.
        return not 0 <= time - self._last < PERIOD_NS

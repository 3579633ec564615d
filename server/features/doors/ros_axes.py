"""Conversion between our axes and those of ROS (REP 103, REP 105, REP 145).

Ours are forward, right, down in the body, and north, east, down in the world, where north is the robot's
direction at its start. ROS's `base_link` is forward, left, up. `odom` is its parent: x points in the
direction at the start, y to the left of it, z up. It is not called a map and has no compass in it. Both pairs
differ by half a turn about x, so one rule converts vectors and another one attitudes.
"""

from collections.abc import Sequence

ODOM, BASE = "odom", "base_link"

Vector = dict[str, float]


def vector(values: Sequence[float]) -> Vector:
    """Return a vector of ours (forward, right, down or north, east, down) in ROS's axes."""
    x, y, z = values
    return {"x": x, "y": 0.0 - y, "z": 0.0 - z}


def quaternion(values: Sequence[float]) -> Vector:
    """Return an attitude of ours (w, x, y, z; body to world) as ROS's, from `base_link` to `odom`."""
    w, x, y, z = values
    return {"x": x, "y": 0.0 - y, "z": 0.0 - z, "w": w}


def stick_axes(linear: Sequence[float], angular: Sequence[float]) -> list[float]:
    """Return the pilot's six axes (x, y, z, roll, pitch, yaw; -1 to 1) of a Twist in `base_link`, limited."""
    x, y, z = linear
    roll, pitch, yaw = angular
    return [max(-1.0, min(1.0, axis)) for axis in (x, 0.0 - y, 0.0 - z, roll, 0.0 - pitch, 0.0 - yaw)]

"""Attitudes as IMU samples."""

from math import cos, sin


def quaternion(heading: float, pitch: float, roll: float) -> tuple[float, float, float, float]:
    """w, x, y, z of a body that is turned by these angles (rad), one after the other."""
    w, x, y, z = cos(heading / 2), 0.0, 0.0, sin(heading / 2)
    for c, s, axis in ((cos(pitch / 2), sin(pitch / 2), 1), (cos(roll / 2), sin(roll / 2), 0)):
        if axis == 1:
            w, x, y, z = w * c - y * s, x * c - z * s, y * c + w * s, z * c + x * s
        else:
            w, x, y, z = w * c - x * s, x * c + w * s, y * c + z * s, z * c - y * s
    return w, x, y, z

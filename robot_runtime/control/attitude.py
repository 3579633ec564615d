"""Heading, pitch and roll from the quaternion of the IMU."""

from math import asin, atan2, pi, remainder


def turned(attitude: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Heading, pitch and roll, rad, of a unit quaternion w, x, y, z from body to world.

    Turned about down by the heading, then about right, then about forward (T. I. Fossen, Handbook of Marine
    Craft Hydrodynamics and Motion Control, 2011, 2.2.2).
    """
    w, x, y, z = attitude
    return (
        atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        asin(min(max(2 * (w * y - z * x), -1.0), 1.0)),
        atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    )


def wrapped(angle: float) -> float:
    """The angle's equal between -π and π."""
    return remainder(angle, 2 * pi)

"""Heading, pitch and roll from the quaternion of the IMU."""

from math import asin, atan2, pi, remainder

GRAVITY = 9.80665
"""m/s²: the standard acceleration of free fall."""


def euler_angles(attitude: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Returns heading, pitch and roll, rad, of a unit quaternion w, x, y, z from body to world.

    They are rotations about down, then right, then forward (T. I. Fossen, Handbook of Marine
    Craft Hydrodynamics and Motion Control, 2011, 2.2.2).
    """
    w, x, y, z = attitude
    return (
        atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        asin(min(max(2 * (w * y - z * x), -1.0), 1.0)),
        atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    )


def heave_acceleration(
    attitude: tuple[float, float, float, float], force: tuple[float, float, float]
) -> float:
    """Returns the downward acceleration, m/s², from attitude and specific force (m/s², body axes).

    Attitude as in `euler_angles`. The error of standard gravity is at most 0.027 m/s², at poles and equator.
    """
    w, x, y, z = attitude
    forward, right, down = force
    turned_down = (
        2 * (x * z - w * y) * forward + 2 * (y * z + w * x) * right + (1 - 2 * (x * x + y * y)) * down
    )
    return turned_down + GRAVITY


def wrap_angle(angle: float) -> float:
    """Returns the equal angle between -π and π."""
    return remainder(angle, 2 * pi)

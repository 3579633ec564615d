"""Heading, pitch, roll and turned vectors from the quaternion of the IMU."""

from math import asin, atan2, pi, remainder

GRAVITY = 9.80665
"""m/s²: the standard acceleration of free fall."""


def euler_angles(attitude: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Return heading, pitch and roll, rad, of a unit quaternion w, x, y, z from body to world.

    They are rotations about down, then right, then forward (T. I. Fossen, Handbook of Marine
    Craft Hydrodynamics and Motion Control, 2011, 2.2.2).
    """
    w, x, y, z = attitude
    return (
        atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        asin(min(max(2 * (w * y - z * x), -1.0), 1.0)),
        atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    )


def turn_to_world(
    attitude: tuple[float, float, float, float], vector: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return the vector (body axes) in world axes: north, east, down. Attitude as in `euler_angles`."""
    w, a, b, c = attitude
    x, y, z = vector
    return (
        (1 - 2 * (b * b + c * c)) * x + 2 * (a * b - w * c) * y + 2 * (a * c + w * b) * z,
        2 * (a * b + w * c) * x + (1 - 2 * (a * a + c * c)) * y + 2 * (b * c - w * a) * z,
        2 * (a * c - w * b) * x + 2 * (b * c + w * a) * y + (1 - 2 * (a * a + b * b)) * z,
    )


def heave_acceleration(
    attitude: tuple[float, float, float, float], force: tuple[float, float, float]
) -> float:
    """Return the downward acceleration, m/s², from attitude and specific force (m/s², body axes).

    Attitude as in `euler_angles`. The error of standard gravity is at most 0.027 m/s², at poles and equator.
    """
    return turn_to_world(attitude, force)[2] + GRAVITY


def wrap_angle(angle: float) -> float:
    """Return the equal angle between -π and π."""
    return remainder(angle, 2 * pi)

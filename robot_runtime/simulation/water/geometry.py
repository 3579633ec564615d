"""Vectors, rotations and the hull's state in plain floats: on three numbers NumPy is ten times slower."""

from math import cos, sin, sqrt
from typing import NamedTuple

from robot_runtime.simulation.water.parameters import Vector

Quaternion = tuple[float, float, float, float]
Matrix = tuple[Vector, Vector, Vector]


def cross(a: Vector, b: Vector) -> Vector:
    """Return a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def rotation(attitude: Quaternion) -> Matrix:
    """Return the rows of the matrix from body axes to world axes."""
    w, x, y, z = attitude
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def to_world(matrix: Matrix, body: Vector) -> Vector:
    """Return a vector in body axes, in world axes."""
    x, y, z = body
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def to_body(matrix: Matrix, world: Vector) -> Vector:
    """Return a vector in world axes, in body axes."""
    x, y, z = world
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z


def attitude_rate(attitude: Quaternion, rate: Vector) -> Quaternion:
    """Return the time derivative of the attitude of a body that turns at `rate` (rad/s, body axes)."""
    w, x, y, z = attitude
    p, q, r = rate
    return (
        -0.5 * (x * p + y * q + z * r),
        0.5 * (w * p + y * r - z * q),
        0.5 * (w * q + z * p - x * r),
        0.5 * (w * r + x * q - y * p),
    )


def normalize(attitude: Quaternion) -> Quaternion:
    """Return the unit quaternion of the same direction."""
    w, x, y, z = attitude
    scale = 1 / sqrt(w * w + x * x + y * y + z * z)
    return w * scale, x * scale, y * scale, z * scale


class BodyState(NamedTuple):
    """The hull's state; also its time derivative, in the same units per second."""

    position: Vector
    """m north, east, down."""
    attitude: Quaternion
    """Unit quaternion w, x, y, z that turns body axes into world axes."""
    velocity: Vector
    """m/s over ground, in body axes."""
    rate: Vector
    """rad/s, in body axes."""


def at_rest(depth: float, north: float = 0.0, east: float = 0.0, heading: float = 0.0) -> BodyState:
    """Return the state of an upright hull at rest at this position (m) and heading (rad)."""
    attitude = (cos(heading / 2), 0.0, 0.0, sin(heading / 2))
    return BodyState((north, east, depth), attitude, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

"""Where the hull is and how it moves."""

from math import cos, sin
from typing import NamedTuple

from robot_runtime.simulation.water.geometry import Quaternion
from robot_runtime.simulation.water.parameters import Vector


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
    """Upright and at rest at this place (m), looking this far (rad) from north to east."""
    attitude = (cos(heading / 2), 0.0, 0.0, sin(heading / 2))
    return BodyState((north, east, depth), attitude, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

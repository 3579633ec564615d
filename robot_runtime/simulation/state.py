"""Where the hull is and how it moves."""

from typing import NamedTuple

from robot_runtime.simulation.geometry import Quaternion
from robot_runtime.simulation.parameters import Vector


class State(NamedTuple):
    """The hull's state; also its time derivative, in the same units per second."""

    position: Vector
    """m north, east, down."""
    attitude: Quaternion
    """Unit quaternion w, x, y, z that turns body axes into world axes."""
    velocity: Vector
    """m/s over ground, in body axes."""
    rate: Vector
    """rad/s, in body axes."""


def at_rest(depth: float) -> State:
    """Upright, looking north, at rest, at this depth (m)."""
    return State((0.0, 0.0, depth), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

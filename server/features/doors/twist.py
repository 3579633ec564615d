"""Twist messages of programs, which drive the robot."""

from typing import Any

from server.features.doors.session import UnusableMessageError

CMD_VEL = "/cmd_vel"
TWIST = "geometry_msgs/msg/Twist"
STOP_TOPIC = "/mucat/stop"
EMPTY = "std_msgs/msg/Empty"
TAKEN_IN = {CMD_VEL: TWIST, STOP_TOPIC: EMPTY}
"""The topics that programs may publish, and their types."""
LIMIT = 1e6


def read_twist(message: Any) -> tuple[list[float], list[float]]:
    """Return the linear and angular parts of a geometry_msgs/Twist; missing fields are 0.

    Raise UnusableMessageError.
    """
    return _read(message, "linear"), _read(message, "angular")


def _read(message: Any, name: str) -> list[float]:
    part = message.get(name, {}) if isinstance(message, dict) else None
    if not isinstance(part, dict):
        raise UnusableMessageError(f"A Twist needs linear and angular, each with x, y and z; {name} is none.")
    values = [part.get(axis, 0.0) for axis in "xyz"]
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int | float) or not -LIMIT <= value <= LIMIT:
            raise UnusableMessageError(f"A Twist's {name} has numbers alone, and no infinite ones.")
    return [float(value) for value in values]

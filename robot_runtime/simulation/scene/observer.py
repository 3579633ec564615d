"""Where a bystander looks from."""

from dataclasses import dataclass
from math import atan2, cos, degrees, pi, radians, sin
from typing import Any, Literal, get_args

import mujoco

from robot_runtime.samples import Truth
from robot_runtime.simulation.geometry import Matrix, rotation
from robot_runtime.simulation.parameters import Vector

FIELD_OF_VIEW = 45.0
"""°, upright: MuJoCo's own for free cameras."""
ELEVATION_MIN, ELEVATION_MAX = -60.0, 89.0
"""° above the robot."""
DISTANCE_MIN, DISTANCE_MAX = 0.4, 15.0
"""m."""

Name = Literal["follow", "side", "top"]
STARTS: dict[str, tuple[float, float, float]] = {
    "follow": (-28.0, 16.0, 1.1),
    "side": (90.0, 4.0, 1.1),
    "top": (0.0, 89.0, 2.6),
}
"""Azimuth (°), elevation (°) and distance (m) of each view before somebody turns it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """One way to look at the robot; "follow" turns with its heading, the others keep to the world.

    Raises ValueError on what cannot be.
    """

    name: Name = "follow"
    azimuth: float = STARTS["follow"][0]
    """°, of the line of sight from the robot's heading, or from north, to the right."""
    elevation: float = STARTS["follow"][1]
    """° from which one looks down."""
    distance: float = STARTS["follow"][2]
    """m."""

    def __post_init__(self) -> None:
        if self.name not in get_args(Name):
            raise ValueError(f"the view is {self.name!r}; there are {', '.join(get_args(Name))}")
        if not -360 <= self.azimuth <= 360:
            raise ValueError(f"the azimuth is {self.azimuth:g}°; it must be between -360 and 360")
        if not ELEVATION_MIN <= self.elevation <= ELEVATION_MAX:
            raise ValueError(
                f"the elevation is {self.elevation:g}°; it must be between {ELEVATION_MIN:g} and {ELEVATION_MAX:g}"
            )
        if not DISTANCE_MIN <= self.distance <= DISTANCE_MAX:
            raise ValueError(
                f"the distance is {self.distance:g} m; it must be between {DISTANCE_MIN:g} and {DISTANCE_MAX:g}"
            )

    def camera(self, truth: Truth) -> tuple[Any, Vector, Matrix]:
        """MuJoCo's camera, where it is in the world (m), and its axes forward, right, down in columns."""
        heading = 0.0
        if self.name == "follow":
            axes = rotation(truth.attitude)
            heading = atan2(axes[1][0], axes[0][0])
        azimuth, elevation = radians(self.azimuth) + heading, radians(self.elevation)
        north, east, down = truth.position
        forward = (cos(azimuth) * cos(elevation), sin(azimuth) * cos(elevation), sin(elevation))
        right = (-sin(azimuth), cos(azimuth), 0.0)
        under = (-cos(azimuth) * sin(elevation), -sin(azimuth) * sin(elevation), cos(elevation))
        camera = mujoco.MjvCamera()
        camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        camera.lookat[:] = north, -east, -down
        camera.distance = self.distance
        # MuJoCo counts its azimuth from its x axis towards its y axis, and an elevation of who looks up.
        camera.azimuth = -degrees(azimuth) % 360
        camera.elevation = -self.elevation
        position = tuple(
            at - self.distance * along for at, along in zip(truth.position, forward, strict=True)
        )
        return camera, (position[0], position[1], position[2]), tuple(zip(forward, right, under, strict=True))  # type: ignore[return-value]

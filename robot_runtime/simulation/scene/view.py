"""The view of an observer of the robot."""

from dataclasses import dataclass
from math import atan2, cos, radians, sin
from typing import Annotated, Literal

from robot_runtime.contract.documents import Truth
from robot_runtime.contract.limits import Range
from robot_runtime.simulation.water.geometry import Matrix, rotation
from robot_runtime.simulation.water.parameters import Vector

FIELD_OF_VIEW = 45.0
"""°, vertical: MuJoCo's default for free cameras."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ObserverView:
    """One way to look at the robot; "follow" turns with its heading, the others keep to the world."""

    name: Literal["follow", "side", "top"] = "follow"
    azimuth: Annotated[float, Range(-360, 360)] = -28.0
    """°, of the line of sight, from the robot's heading or from north, to the right."""
    elevation: Annotated[float, Range(-60, 89)] = 16.0
    """° above the robot."""
    distance: Annotated[float, Range(0.4, 15)] = 1.1
    """m."""

    def line_of_sight(self, truth: Truth) -> tuple[float, float]:
        """Return azimuth, from north to the right, and elevation, downwards, of the line of sight (rad)."""
        heading = 0.0
        if self.name == "follow":
            axes = rotation(truth.attitude)
            heading = atan2(axes[1][0], axes[0][0])
        return radians(self.azimuth) + heading, radians(self.elevation)

    def eye(self, truth: Truth) -> tuple[Vector, Matrix]:
        """Return the observer's position (m) and its axes forward, right, down, as `rotation` does."""
        azimuth, elevation = self.line_of_sight(truth)
        c, s, level, steep = cos(azimuth), sin(azimuth), cos(elevation), sin(elevation)
        axes = ((c * level, -s, -c * steep), (s * level, c, -s * steep), (steep, 0.0, level))
        north, east, down = (
            at - self.distance * line[0] for at, line in zip(truth.position, axes, strict=True)
        )
        return (north, east, down), axes

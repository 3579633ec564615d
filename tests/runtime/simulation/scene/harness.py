"""Poses of the robot, in degrees, for rendered pictures."""

from math import cos, radians, sin

import cv2
import numpy as np

from robot_runtime.contract.documents import Truth
from robot_runtime.simulation.scene.contents import Contents, SceneWater, Target
from robot_runtime.simulation.scene.water import Kind
from robot_runtime.simulation.water.parameters import Vector
from robot_runtime.simulation.water.surroundings import Basin
from robot_runtime.vision.picture import Picture


def truth(
    position: Vector = (0.0, 0.0, 5.0), roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0
) -> Truth:
    """Return the truth of a robot at rest at this position (m) and attitude (°)."""
    r, p, y = (radians(angle) / 2 for angle in (roll, pitch, yaw))
    attitude = (
        cos(r) * cos(p) * cos(y) + sin(r) * sin(p) * sin(y),
        sin(r) * cos(p) * cos(y) - cos(r) * sin(p) * sin(y),
        cos(r) * sin(p) * cos(y) + sin(r) * cos(p) * sin(y),
        cos(r) * cos(p) * sin(y) - sin(r) * sin(p) * cos(y),
    )
    still = (0.0, 0.0, 0.0)
    return Truth(position=position, attitude=attitude, velocity=still, rate=still, fins=(0.0,) * 4)


def open_water(*targets: Target, kind: Kind = "pool", turbidity: float = 0.0) -> Contents:
    """Deep, empty water; by default a pool whose walls are far away."""
    position = SceneWater(kind=kind, turbidity=turbidity)
    return Contents(water=position, basin=Basin(40.0), beacons=(), targets=targets)


def changed(picture: Picture, empty: Picture, least: int = 25) -> Picture:
    """Return a mask: 255 where a byte differs by more than `least`, and on lines of targets; else 0."""
    apart = np.abs(picture.astype(int) - empty.astype(int)).max(axis=2)
    mask = np.where(apart > least, 255, 0).astype(np.uint8)
    return cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((5, 5), np.uint8)).astype(np.uint8)


def centre(mask: Picture) -> tuple[float, float]:
    """Return the centre of a mask, as shares of the picture's width and height."""
    down, right = np.nonzero(mask)
    assert len(down) > 20
    return float(right.mean() / mask.shape[1]), float(down.mean() / mask.shape[0])

"""The simulated water as camera and bystander see it, side by side."""

from pathlib import Path

import cv2
import numpy as np

from robot_runtime.contract.documents import Truth
from robot_runtime.simulation.scene.contents import START_BASIN, Contents
from robot_runtime.simulation.scene.scene import SceneRenderer
from robot_runtime.simulation.scene.view import ObserverView
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.surroundings import Basin

TIME = 4.0
POSITION = (0.0, 0.0, 1.0)
"""m north, east, down."""
STROKE = (0.4, -0.4, -0.4, 0.4)
"""rad, of the four fins."""
POOL = Basin(START_BASIN.depth, 12.0, 5.0)
CAMERA, BYSTANDER, GAP = (480, 360), (480, 270), 6


def write_scene(file: Path, quality: int) -> None:
    """Write natural water on the left and a pool on the right, as a JPEG of this quality."""
    columns = []
    still = (0.0, 0.0, 0.0)
    truth = Truth(position=POSITION, attitude=(1.0, 0.0, 0.0, 0.0), velocity=still, rate=still, fins=STROKE)
    for basin in (START_BASIN, POOL):
        with SceneRenderer(Contents(basin=basin), SimulationParameters()) as scene:
            seen = scene.render_camera(TIME, truth, *CAMERA)
            watched = scene.render_observer(TIME, truth, ObserverView(), *BYSTANDER)
        gap = np.full((GAP, CAMERA[0], 3), 255, np.uint8)
        columns.append(np.vstack([seen, gap, watched]))
    between = np.full((columns[0].shape[0], GAP, 3), 255, np.uint8)
    cv2.imwrite(str(file), np.hstack([columns[0], between, columns[1]]), [cv2.IMWRITE_JPEG_QUALITY, quality])

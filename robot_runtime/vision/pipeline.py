"""The parts of the vision node that need NumPy and OpenCV: cameras, detector and JPEG encoding.

The vision process alone imports this module: no crash of a decoder reaches the control loop.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import cv2

from robot_runtime.clock import Clock
from robot_runtime.config import VisionConfig
from robot_runtime.vision.balance import BALANCES as BALANCES
from robot_runtime.vision.camera import Camera
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.cards import CameraCard
from robot_runtime.vision.cards import make_card as make_card
from robot_runtime.vision.colour_picker import PickPoint as PickPoint
from robot_runtime.vision.colour_picker import propose as propose
from robot_runtime.vision.detector import Detector as Detector
from robot_runtime.vision.detector import choose_target as choose_target
from robot_runtime.vision.file_camera import FileCamera
from robot_runtime.vision.patches import draw_mask as draw_mask
from robot_runtime.vision.pi_camera import PiCamera
from robot_runtime.vision.picture import Picture
from robot_runtime.vision.scene_camera import SceneCamera, SceneMissingError
from robot_runtime.vision.usb_camera import UsbCamera

if TYPE_CHECKING:
    from robot_runtime.transport.zenoh_transport import ZenohTransport

JPEG_QUALITY = 80
THUMBNAIL_WIDTH = 160
THUMBNAIL_QUALITY = 50

# More threads cost more than they gain on such small pictures, and the robot has one core.
cv2.setNumThreads(1)


def open_camera(
    config: VisionConfig,
    clock: Clock,
    connect: "Callable[[], ZenohTransport] | None",
    card: Callable[[], CameraCard | None],
    on_missing: Callable[[str], None],
) -> Camera:
    """Opens the configured camera, or a card camera if no scene can be rendered; `on_missing` gets why.

    The scene is queried through what `connect` opens.

    Raises CameraError.
    """
    if config.camera == "pi":
        return PiCamera(config.width, config.height, config.rate, clock)
    if config.camera == "usb":
        return UsbCamera(config.file, config.width, config.height, config.rate, clock)
    if config.camera == "file":
        return FileCamera(Path(config.file), config.width, config.height, clock)
    if config.camera == "scene" and connect is not None:
        try:
            return SceneCamera(config.width, config.height, connect(), card)
        except SceneMissingError as missing:
            on_missing(str(missing))
    return CardCamera(config.width, config.height, clock, card)


def as_jpeg(picture: Picture) -> bytes:
    """Returns the picture as a JPEG file."""
    return _encode(picture, JPEG_QUALITY)


def as_thumbnail(picture: Picture) -> bytes:
    """Returns a small copy of the picture as a JPEG file."""
    height, width = picture.shape[:2]
    size = (THUMBNAIL_WIDTH, max(1, round(height * THUMBNAIL_WIDTH / width)))
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(picture.dtype, copy=False)
    return _encode(small, THUMBNAIL_QUALITY)


def _encode(picture: Picture, quality: int) -> bytes:
    _, jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return jpeg.tobytes()

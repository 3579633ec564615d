"""The parts of the vision node that need NumPy and OpenCV: cameras, detector and JPEG encoding.

They are loaded with this module, in the node's own thread: that takes longer than all the rest of a start,
and the board should not wait for it.
"""

from collections.abc import Callable
from pathlib import Path

import cv2

from robot_runtime.clock import Clock
from robot_runtime.config import VisionConfig
from robot_runtime.transport.zenoh_transport import ZenohTransport
from robot_runtime.vision.camera import Camera
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.cards import CameraCard
from robot_runtime.vision.cards import make_card as make_card
from robot_runtime.vision.colour_picker import PickPoint as PickPoint
from robot_runtime.vision.colour_picker import propose as propose
from robot_runtime.vision.detector import Detector as Detector
from robot_runtime.vision.file_camera import FileCamera
from robot_runtime.vision.patches import draw_mask as draw_mask
from robot_runtime.vision.pi_camera import PiCamera
from robot_runtime.vision.picture import Picture
from robot_runtime.vision.scene_camera import SceneCamera, SceneMissingError

JPEG_QUALITY = 80
THUMBNAIL_WIDTH = 160
THUMBNAIL_QUALITY = 50

# On pictures of this size more threads cost more than they bring, and the robot has one core.
cv2.setNumThreads(1)


def open_camera(
    config: VisionConfig,
    clock: Clock,
    messages: ZenohTransport | None,
    card: Callable[[], CameraCard | None],
    on_missing: Callable[[str], None],
) -> Camera:
    """The configured camera; a drawn card, after `on_missing` was told why, where no scene can be rendered.

    Raises CameraError.
    """
    if config.camera == "pi":
        return PiCamera(config.width, config.height, clock)
    if config.camera == "file":
        return FileCamera(Path(config.file), config.width, config.height, clock)
    if config.camera == "scene" and messages is not None:
        try:
            return SceneCamera(config.width, config.height, messages, card)
        except SceneMissingError as missing:
            on_missing(str(missing))
    return CardCamera(config.width, config.height, clock, card)


def as_jpeg(picture: Picture) -> bytes:
    """The picture as a JPEG file."""
    return _encode(picture, JPEG_QUALITY)


def as_thumbnail(picture: Picture) -> bytes:
    """A small one, as a JPEG file."""
    height, width = picture.shape[:2]
    size = (THUMBNAIL_WIDTH, max(1, round(height * THUMBNAIL_WIDTH / width)))
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(picture.dtype, copy=False)
    return _encode(small, THUMBNAIL_QUALITY)


def _encode(picture: Picture, quality: int) -> bytes:
    _, jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return jpeg.tobytes()

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
from robot_runtime.vision.camera import Camera, SensorControls
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.cards import CameraCard
from robot_runtime.vision.cards import make_card as make_card
from robot_runtime.vision.colour_picker import PickPoint as PickPoint
from robot_runtime.vision.colour_picker import propose as propose
from robot_runtime.vision.detector import Detector as Detector
from robot_runtime.vision.detector import choose_target as choose_target
from robot_runtime.vision.file_camera import FileCamera
from robot_runtime.vision.patches import draw_mask as draw_mask
from robot_runtime.vision.patches import draw_preview as draw_preview
from robot_runtime.vision.pi_camera import PiCamera
from robot_runtime.vision.picture import Picture
from robot_runtime.vision.scene_camera import SceneCamera, SceneMissingError
from robot_runtime.vision.shape import before_turn as before_turn
from robot_runtime.vision.shape import fit as fit
from robot_runtime.vision.shape import turn as turn
from robot_runtime.vision.stream_quality import StreamStep
from robot_runtime.vision.usb_camera import UsbCamera

if TYPE_CHECKING:
    from robot_runtime.transport.zenoh_transport import ZenohTransport

JPEG_QUALITY = 80
THUMBNAIL_WIDTH = 160
THUMBNAIL_QUALITY = 50
SNAPSHOT_QUALITY = 95

# More threads cost more than they gain on such small pictures, and the robot has one core.
cv2.setNumThreads(1)


def open_camera(
    config: VisionConfig,
    clock: Clock,
    connect: "Callable[[], ZenohTransport] | None",
    card: Callable[[], CameraCard | None],
    on_missing: Callable[[str], None],
) -> Camera:
    """Open the configured camera, or a card camera if no scene can be rendered; `on_missing` gets the reason.

    A device is opened for the stream, in its size and at its rate or the vision's higher one; others give
    pictures of any size at any time. The scene is queried through what `connect` opens.

    Raise CameraError.
    """
    width, height = before_turn(max(config.size, config.stream_size), config.turn)
    rate = max(config.rate, config.stream_rate)
    controls = SensorControls(config.exposure, config.gain, config.colour_temperature)
    if config.camera == "pi":
        return PiCamera(width, height, rate, clock, controls)
    if config.camera == "usb":
        return UsbCamera(config.file, width, height, rate, clock, controls)
    if config.camera == "file":
        return FileCamera(Path(config.file), width, height, clock)
    if config.camera == "scene" and connect is not None:
        try:
            return SceneCamera(width, height, connect(), card)
        except SceneMissingError as missing:
            on_missing(str(missing))
    return CardCamera(width, height, clock, card)


def as_jpeg(picture: Picture) -> bytes:
    """Return the picture as a JPEG file."""
    return _encode(picture, JPEG_QUALITY)


def as_stream(picture: Picture, size: tuple[int, int], step: StreamStep) -> bytes:
    """Return the picture as a JPEG file of this step's share of `size`, width and height."""
    width, height = size
    return _encode(fit(picture, round(width * step.scale), round(height * step.scale)), step.quality)


def as_snapshot(picture: Picture) -> bytes:
    """Return the picture as a JPEG file of the best quality that is worth its bytes."""
    return _encode(picture, SNAPSHOT_QUALITY)


def as_thumbnail(picture: Picture) -> bytes:
    """Return a small copy of the picture as a JPEG file."""
    height, width = picture.shape[:2]
    size = (THUMBNAIL_WIDTH, max(1, round(height * THUMBNAIL_WIDTH / width)))
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA).astype(picture.dtype, copy=False)
    return _encode(small, THUMBNAIL_QUALITY)


def _encode(picture: Picture, quality: int) -> bytes:
    _, jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return jpeg.tobytes()

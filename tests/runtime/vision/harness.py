"""Pictures and cameras for the vision tests."""

from collections.abc import Mapping
from itertools import cycle
from struct import Struct
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Box
from robot_runtime.contract.vision_settings import COLOURS, ColourRange, VisionSettings
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.cards import make_card
from robot_runtime.vision.detector import Detector
from robot_runtime.vision.picture import Picture


class Found(NamedTuple):
    """A detection: colour, box and area."""

    colour: str
    box: Box
    area: float


def find(
    picture: Picture, expected: str, area_min: float = 0.01, colours: Mapping[str, ColourRange] = COLOURS
) -> Found | None:
    """Run the detector with this colour first; None where it finds nothing."""
    settings = VisionSettings(colour=expected, colours=dict(colours), area_min=area_min)
    sight = Detector(settings).search(picture)
    if sight.patch is None:
        return None
    assert sight.colour is not None
    return Found(sight.colour, sight.patch.box, sight.patch.area)


def drawn(time: float, card: str | None, width: int = 320, height: int = 240) -> Picture:
    """Return the card camera's picture at this time."""
    held = make_card(card, COLOURS) if card else None
    return CardCamera(width, height, SimulatedClock(), lambda: None).draw(time, held)


class ShakyCamera(Camera):
    """Shows one picture; raises `failure` as long as it is set."""

    def __init__(self, picture: Picture, clock: SimulatedClock) -> None:
        self.picture = picture
        self.clock = clock
        self.failure: Exception | None = None
        self.opened = 0
        self.closed = 0

    def open(self) -> "ShakyCamera":
        self.opened += 1
        if isinstance(self.failure, CameraError):
            raise self.failure
        return self

    def read(self) -> CameraFrame:
        if self.failure is not None:
            raise self.failure
        return CameraFrame(self.picture, self.clock.now())

    def close(self) -> None:
        self.closed += 1

    def __str__(self) -> str:
        return "shaky camera"


class VideoControls:
    """Stands in for cv2.VideoCapture of a device whose controls are not `fixed`, and notes what is set."""

    def __init__(self, fixed: tuple[int, ...] = ()) -> None:
        self._fixed = fixed
        self.set_to: list[tuple[int, float]] = []

    def __call__(self, _: str, backend: int) -> "VideoControls":
        assert backend == cv2.CAP_V4L2
        return self

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        return True

    def set(self, control: int, value: float) -> bool:
        # Video4Linux refuses an exposure or a white by number while the camera chooses it.
        chosen = dict(self.set_to)
        automatic = {
            cv2.CAP_PROP_EXPOSURE: chosen.get(cv2.CAP_PROP_AUTO_EXPOSURE, 3) != 1,
            cv2.CAP_PROP_WB_TEMPERATURE: chosen.get(cv2.CAP_PROP_AUTO_WB, 1) != 0,
        }
        if control in self._fixed or automatic.get(control, False):
            return False
        self.set_to.append((control, value))
        return True

    def get(self, control: int) -> float:
        return dict(self.set_to).get(control, -1.0)


class JpegDevice(VideoControls):
    """Stands in for cv2.VideoCapture of a camera that gives these JPEG files in turn, of 640 × 480 pixels.

    `code` is the format that it really has. OpenCV decodes its pictures unless it is set not to.
    """

    def __init__(self, files: list[bytes], code: str = "MJPG") -> None:
        super().__init__()
        self.files = cycle(files)
        self._format = float(cv2.VideoWriter.fourcc(*code))

    @property
    def converts(self) -> bool:
        return bool(self.get(cv2.CAP_PROP_CONVERT_RGB))

    def get(self, control: int) -> float:
        own = {
            cv2.CAP_PROP_FOURCC: self._format,
            cv2.CAP_PROP_FRAME_WIDTH: 640.0,
            cv2.CAP_PROP_FRAME_HEIGHT: 480.0,
        }
        return own.get(control, super().get(control))

    def grab(self) -> bool:
        next(self.files)
        return True

    def read(self) -> tuple[bool, NDArray[Any] | None]:
        data = np.frombuffer(next(self.files), np.uint8).reshape(1, -1)
        return True, cv2.imdecode(data, cv2.IMREAD_COLOR) if self.converts else data

    def release(self) -> None:
        """Do nothing; nothing is open."""


def uncompressed_video() -> bytes:
    """Return an AVI file of six uncompressed pictures, 48 × 36 pixels, ten a second.

    The FFmpeg of OpenCV 5.0.0 damages its heap on such files.
    """
    width, height, count = 48, 36, 6

    def chunk(name: bytes, data: bytes) -> bytes:
        return name + Struct("<I").pack(len(data)) + data

    size = width * height * 3
    head = Struct("<14I").pack(100_000, size * 10, 0, 16, count, 0, 1, size, width, height, 0, 0, 0, 0)
    stream = Struct("<4s4sIHHIIIIIIII4H").pack(
        b"vids", b"DIB ", 0, 0, 0, 0, 1, 10, 0, count, size, 0xFFFFFFFF, 0, 0, 0, width, height
    )
    form = Struct("<IiiHHIIiiII").pack(40, width, height, 1, 24, 0, size, 0, 0, 0, 0)
    streams = chunk(b"LIST", b"strl" + chunk(b"strh", stream) + chunk(b"strf", form))
    pictures = b"".join(chunk(b"00db", bytes([40 * number]) * size) for number in range(count))
    entries = b"".join(
        Struct("<4sIII").pack(b"00db", 16, 4 + number * (size + 8), size) for number in range(count)
    )
    lists = chunk(b"LIST", b"hdrl" + chunk(b"avih", head) + streams)
    return chunk(b"RIFF", b"AVI " + lists + chunk(b"LIST", b"movi" + pictures) + chunk(b"idx1", entries))

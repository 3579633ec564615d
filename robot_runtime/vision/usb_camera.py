"""A USB camera, by Video4Linux through OpenCV."""

from pathlib import Path

import cv2
import numpy as np

from robot_runtime.clock import Clock
from robot_runtime.vision.camera import (
    NO_CONTROLS,
    Camera,
    CameraError,
    CameraFrame,
    SensorControls,
    taken_at,
)
from robot_runtime.vision.picture import Picture
from robot_runtime.vision.shape import describe_fit, fit
from robot_runtime.vision.video_device import check_device, describe_sizes

FIRST_DEVICE = "/dev/video0"
BUFFERS = 2
"""Pictures that the driver holds: the newest is the second one at most."""
DAMAGED_MAX = 5
"""JPEG files in a row that are cut off; most cameras cut off one now and then, and their first."""
MILLISECONDS = 1e3
EXPOSURE_UNITS = 10
"""Of Video4Linux in a ms."""
MOTION_JPEG = cv2.VideoWriter.fourcc(*"MJPG")
_START, _END, _CODES, _SCAN = b"\xff\xd8", b"\xff\xd9", b"\xff\xc4", b"\xff\xda"
"""Markers of a JPEG file (ITU-T T.81, table B.1): start and end, Huffman tables, start of the scan."""
_FIXED_EXPOSURE, _OWN_EXPOSURES = 1, (3, 0)
"""Video4Linux' kinds of exposure: manual; by the camera for a fixed aperture, or for any."""


class UsbCamera(Camera):
    """A camera by a Video4Linux device, asked for pictures of `width` × `height` pixels.

    Where the device gives Motion JPEG, each picture has its JPEG file and is decoded only if it is read.
    `device` is its path, or the first one if empty. What `controls` leaves automatic is set so: a camera
    remembers what another program has fixed. Raises CameraError where there is none, where it may not be
    opened, and where it is in use.
    """

    def __init__(
        self,
        device: str,
        width: int,
        height: int,
        rate: float,
        clock: Clock,
        controls: SensorControls = NO_CONTROLS,
    ) -> None:
        self._path = device or FIRST_DEVICE
        self.size = (width, height)
        self._clock = clock
        check_device(Path(self._path))
        self._capture = cv2.VideoCapture(self._path, cv2.CAP_V4L2)
        if not self._capture.isOpened():
            raise CameraError(
                f"{self._path} gives no video: it is no camera, or has no pictures that OpenCV can read; "
                "name the camera's device in robot.toml: [vision] file"
            )
        self.rate = rate
        self._capture.set(cv2.CAP_PROP_FOURCC, MOTION_JPEG)
        self._capture.set(cv2.CAP_PROP_FRAME_WIDTH, width)
        self._capture.set(cv2.CAP_PROP_FRAME_HEIGHT, height)
        self._capture.set(cv2.CAP_PROP_FPS, rate)
        self._capture.set(cv2.CAP_PROP_BUFFERSIZE, BUFFERS)
        self._given = (
            round(self._capture.get(cv2.CAP_PROP_FRAME_WIDTH)),
            round(self._capture.get(cv2.CAP_PROP_FRAME_HEIGHT)),
        )
        # Listed once: the text is read after each picture.
        self._sizes = "" if self._given == self.size else describe_sizes(Path(self._path), self._format)
        self._refused = self._control(controls)
        # The driver decides on the format with the size.
        self._gives_jpeg = self._format == MOTION_JPEG and self._capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)

    def read(self) -> CameraFrame:
        """Return the newest picture. Raise CameraError if the camera gives none."""
        size = self.size
        if not self._gives_jpeg:
            return CameraFrame(self._fit(self._receive(), size), self._taken())
        for _ in range(DAMAGED_MAX):
            jpeg = self._receive().tobytes()
            if not jpeg.startswith(_START):
                # The device names Motion JPEG but gives something else: OpenCV converts what it can.
                self._gives_jpeg = False
                self._capture.set(cv2.CAP_PROP_CONVERT_RGB, 1)
                return self.read()
            if (end := jpeg.rfind(_END)) >= 0:
                # A driver may leave something behind the file's end.
                return self._frame(jpeg[: end + len(_END)], size)
        raise CameraError(f"the camera {self._path} gives damaged pictures; check its plug and cable")

    def skip(self) -> None:
        """Take the next picture from the driver without decoding it. Raise CameraError."""
        if not self._capture.grab():
            raise CameraError(f"the camera {self._path} gives no picture; check its plug")

    def close(self) -> None:
        """Release the camera."""
        self._capture.release()

    def __str__(self) -> str:
        width, height = self._given
        form = " as JPEG" if self._gives_jpeg else ""
        notes = [describe_fit(self._given, *self.size) or f"{width} × {height}{form}"]
        if self._sizes:
            notes.append(f"it gives {self._sizes}")
        if self._refused:
            notes.append(f"it does not fix {', '.join(self._refused)}")
        return f"USB camera {self._path} ({'; '.join(notes)})"

    @property
    def _format(self) -> int:
        """The four characters of the device's format as a number."""
        return round(self._capture.get(cv2.CAP_PROP_FOURCC))

    def _receive(self) -> Picture:
        """Return what the device gives next: a picture, or the bytes of a JPEG file."""
        ok, data = self._capture.read()
        if not ok or data is None:
            raise CameraError(f"the camera {self._path} gives no picture; check its plug")
        return data.astype(np.uint8, copy=False)

    def _frame(self, jpeg: bytes, size: tuple[int, int]) -> CameraFrame:
        """Return the frame of a JPEG file, which has `size` when it is decoded."""

        def decode() -> Picture:
            picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
            if picture is None:
                raise CameraError(f"the camera {self._path} gives damaged pictures; check its plug and cable")
            return self._fit(picture.astype(np.uint8, copy=False), size)

        # Old cameras leave out the Huffman tables; not every browser then knows the usual ones.
        is_complete = self._given == size and _CODES in jpeg[: jpeg.find(_SCAN)]
        return CameraFrame(decode, self._taken(), jpeg if is_complete else None)

    def _fit(self, picture: Picture, size: tuple[int, int]) -> Picture:
        self._given = (picture.shape[1], picture.shape[0])
        return fit(picture, *size)

    def _control(self, controls: SensorControls) -> list[str]:
        """Fix what `controls` fixes, leave the rest to the camera, and return what it refuses to fix."""
        refused = []
        if controls.exposure:
            self._capture.set(cv2.CAP_PROP_AUTO_EXPOSURE, _FIXED_EXPOSURE)
            if not self._capture.set(cv2.CAP_PROP_EXPOSURE, controls.exposure * EXPOSURE_UNITS):
                refused.append("the exposure")
        else:
            any(self._capture.set(cv2.CAP_PROP_AUTO_EXPOSURE, kind) for kind in _OWN_EXPOSURES)
        # Video4Linux has no common switch for an automatic gain: it goes with the exposure.
        if controls.gain and not self._capture.set(cv2.CAP_PROP_GAIN, controls.gain):
            refused.append("the gain")
        self._capture.set(cv2.CAP_PROP_AUTO_WB, 0.0 if controls.colour_temperature else 1.0)
        if controls.colour_temperature and not self._capture.set(
            cv2.CAP_PROP_WB_TEMPERATURE, controls.colour_temperature
        ):
            refused.append("the colour temperature")
        return refused

    def _taken(self) -> float:
        """Return the driver's time of the picture (s), or now where the driver uses another clock."""
        return taken_at(self._capture.get(cv2.CAP_PROP_POS_MSEC) / MILLISECONDS, self._clock.now())

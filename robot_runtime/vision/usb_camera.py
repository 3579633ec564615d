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
from robot_runtime.vision.shape import describe_fit, fit
from robot_runtime.vision.video_device import check_device

FIRST_DEVICE = "/dev/video0"
BUFFERS = 2
"""Pictures that the driver holds: the newest is the second one at most."""
MILLISECONDS = 1e3
EXPOSURE_UNITS = 10
"""Of Video4Linux in a ms."""
_FIXED_EXPOSURE, _OWN_EXPOSURES = 1, (3, 0)
"""Video4Linux' kinds of exposure: manual; by the camera for a fixed aperture, or for any."""


class UsbCamera(Camera):
    """A camera by a Video4Linux device, asked for pictures of `width` × `height` pixels.

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
        self.size = self._given = (width, height)
        self._clock = clock
        check_device(Path(self._path))
        self._capture = cv2.VideoCapture(self._path, cv2.CAP_V4L2)
        if not self._capture.isOpened():
            raise CameraError(
                f"{self._path} gives no video: it is no camera, or has no pictures that OpenCV can read; "
                "name the camera's device in robot.toml: [vision] file"
            )
        self.rate = rate
        self._capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
        self._capture.set(cv2.CAP_PROP_FRAME_WIDTH, width)
        self._capture.set(cv2.CAP_PROP_FRAME_HEIGHT, height)
        self._capture.set(cv2.CAP_PROP_FPS, rate)
        self._capture.set(cv2.CAP_PROP_BUFFERSIZE, BUFFERS)
        self._refused = self._control(controls)

    def read(self) -> CameraFrame:
        """Return the newest picture. Raise CameraError if the camera gives none."""
        ok, picture = self._capture.read()
        if not ok or picture is None:
            raise CameraError(f"the camera {self._path} gives no picture; check its plug")
        self._given = (picture.shape[1], picture.shape[0])
        fitted = fit(picture.astype(np.uint8, copy=False), *self.size)
        return CameraFrame(fitted, self._taken())

    def skip(self) -> None:
        """Take the next picture from the driver without decoding it. Raise CameraError."""
        if not self._capture.grab():
            raise CameraError(f"the camera {self._path} gives no picture; check its plug")

    def close(self) -> None:
        """Release the camera."""
        self._capture.release()

    def __str__(self) -> str:
        width, height = self._given
        notes = [describe_fit(self._given, *self.size) or f"{width} × {height}"]
        if self._refused:
            notes.append(f"it does not fix {', '.join(self._refused)}")
        return f"USB camera {self._path} ({'; '.join(notes)})"

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

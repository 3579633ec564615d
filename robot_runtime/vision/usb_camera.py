"""A USB camera, by Video4Linux through OpenCV."""

import errno
import os
from pathlib import Path

import cv2
import numpy as np

from robot_runtime.clock import Clock
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame, taken_at
from robot_runtime.vision.shape import describe_fit, fit

FIRST_DEVICE = "/dev/video0"
BUFFERS = 2
"""Pictures that the driver holds: the newest is the second one at most."""
MILLISECONDS = 1e3


class UsbCamera(Camera):
    """Takes pictures of a Video4Linux device, fitted to `width` × `height` pixels.

    `device` is its path, or the first one if empty. Raises CameraError where there is none, where it may not
    be opened, and where it is in use.
    """

    def __init__(self, device: str, width: int, height: int, rate: float, clock: Clock) -> None:
        self._path = device or FIRST_DEVICE
        self._size = self._given = (width, height)
        self._clock = clock
        _check(Path(self._path))
        self._capture = cv2.VideoCapture(self._path, cv2.CAP_V4L2)
        if not self._capture.isOpened():
            raise CameraError(
                f"{self._path} gives no video: it is no camera, or another program uses it; "
                "name the camera's device in robot.toml: [vision] file"
            )
        self.rate = rate
        self._capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
        self._capture.set(cv2.CAP_PROP_FRAME_WIDTH, width)
        self._capture.set(cv2.CAP_PROP_FRAME_HEIGHT, height)
        self._capture.set(cv2.CAP_PROP_FPS, rate)
        self._capture.set(cv2.CAP_PROP_BUFFERSIZE, BUFFERS)

    def read(self) -> CameraFrame:
        """Returns the newest picture. Raises CameraError if the camera gives none."""
        ok, picture = self._capture.read()
        if not ok or picture is None:
            raise CameraError(f"the camera {self._path} gives no picture; check its plug")
        self._given = (picture.shape[1], picture.shape[0])
        fitted = fit(picture.astype(np.uint8, copy=False), *self._size)
        return CameraFrame(fitted, self._taken())

    def close(self) -> None:
        """Releases the camera."""
        self._capture.release()

    def __str__(self) -> str:
        fitted = describe_fit(self._given, *self._size)
        return f"USB camera {self._path}" + (f" ({fitted})" if fitted else "")

    def _taken(self) -> float:
        """The driver's time of the picture (s), or now where its clock is another one."""
        return taken_at(self._capture.get(cv2.CAP_PROP_POS_MSEC) / MILLISECONDS, self._clock.now())


def _check(path: Path) -> None:
    try:
        os.close(os.open(path, os.O_RDWR | os.O_NONBLOCK))
    except FileNotFoundError as problem:
        others = ", ".join(str(one) for one in sorted(Path("/dev").glob("video*"))) or "none"
        raise CameraError(
            f"there is no camera {path} (devices: {others}); plug it in, or name its device in robot.toml: "
            "[vision] file"
        ) from problem
    except PermissionError as problem:
        raise CameraError(
            f"the camera {path} may not be opened: put the user into the group video, "
            "`sudo usermod -aG video USER`, then start again"
        ) from problem
    except OSError as problem:
        why = "another program uses it" if problem.errno == errno.EBUSY else problem.strerror
        raise CameraError(f"the camera {path} cannot be opened: {why}") from problem

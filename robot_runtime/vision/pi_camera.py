"""The Raspberry Pi's own camera, through picamera2."""

from importlib import import_module
from typing import Any

import numpy as np

from robot_runtime.clock import Clock
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame, taken_at

BUFFERS = 2
"""Pictures that the camera fills in turn: one is searched while the next one comes. More would be older."""
NANOSECONDS = 1e9


class PiCamera(Camera):
    """Takes `rate` pictures of `width` × `height` pixels a second.

    Raises CameraError without picamera2 or a camera, and where the camera is in use.
    """

    def __init__(self, width: int, height: int, rate: float, clock: Clock) -> None:
        self._clock = clock
        self.rate = rate
        self._device = _open_device(width, height, rate)

    def read(self) -> CameraFrame:
        """Returns the newest picture. Raises CameraError if the camera gives none."""
        try:
            request = self._device.capture_request()
            try:
                picture = np.ascontiguousarray(request.make_array("main")[:, :, :3], dtype=np.uint8)
                stamp = request.get_metadata().get("SensorTimestamp")
            finally:
                request.release()
        except Exception as problem:
            raise CameraError(f"the Pi camera gives no picture ({problem}); check its cable") from problem
        # libcamera counts from the computer's start; a Pi never sleeps, so that this is the steady clock.
        return CameraFrame(picture, taken_at((stamp or 0) / NANOSECONDS, self._clock.now()))

    def close(self) -> None:
        """Releases the camera."""
        self._device.close()

    def __str__(self) -> str:
        return "Pi camera"


def _open_device(width: int, height: int, rate: float) -> Any:
    library = _import_library()
    try:
        cameras = library.Picamera2.global_camera_info()
    except Exception as problem:
        raise CameraError(f"the Pi's cameras cannot be listed ({problem})") from problem
    if not cameras:
        raise CameraError(
            "no camera is connected to the Pi: check its cable at both ends with the power off, then look at "
            "`rpicam-hello --list-cameras`; a USB camera has camera = 'usb' in robot.toml"
        )
    device = None
    try:
        device = library.Picamera2()
        # libcamera's RGB888 is blue, green, red in memory, which is OpenCV's order.
        device.configure(
            device.create_video_configuration(
                main={"size": (width, height), "format": "RGB888"},
                controls={"FrameRate": rate},
                buffer_count=BUFFERS,
            )
        )
        device.start()
    except Exception as problem:
        # picamera2 raises RuntimeError, OSError and others, depending on what is missing.
        if device is not None:
            device.close()
        raise CameraError(f"the Pi camera does not start ({problem}); {_remedy(problem)}") from problem
    return device


def _import_library() -> Any:
    try:
        return import_module("picamera2")
    except ImportError as problem:
        raise CameraError(
            f"the Pi camera needs picamera2, which cannot be loaded ({problem}): run `sudo apt install "
            "python3-picamera2`, and let the virtual environment see the system's packages"
        ) from problem
    except ValueError as problem:
        # The system's simplejpeg, which picamera2 loads, says so where its NumPy is another one.
        raise CameraError(
            f"picamera2 was built for another NumPy than this environment's ({problem}): use Raspberry Pi "
            "OS 13, whose picamera2 fits, or a USB camera"
        ) from problem
    except Exception as problem:
        raise CameraError(f"picamera2 cannot be loaded ({problem}); install it again") from problem


def _remedy(problem: Exception) -> str:
    words = str(problem).lower()
    if isinstance(problem, PermissionError) or "permission" in words:
        return "put the user into the group video: `sudo usermod -aG video USER`, then start again"
    if "busy" in words or "did not acquire" in words or "in use" in words or "acquire" in words:
        return "another program uses it: end that one"
    return "check its cable, and that no other program uses it"

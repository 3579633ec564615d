"""The Raspberry Pi's own camera, through picamera2."""

from importlib import import_module
from typing import Any

import numpy as np

from robot_runtime.clock import Clock
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame


class PiCamera(Camera):
    """Takes pictures of `width` × `height` pixels. Raises CameraError without picamera2 or a camera."""

    def __init__(self, width: int, height: int, clock: Clock) -> None:
        self._clock = clock
        self._device = _open_device(width, height)

    def read(self) -> CameraFrame:
        """Returns the newest picture. Raises CameraError if the camera gives none."""
        try:
            picture = self._device.capture_array("main")
        except Exception as problem:
            raise CameraError(f"the Pi camera gives no picture ({problem}); check its cable") from problem
        return CameraFrame(np.ascontiguousarray(picture[:, :, :3], dtype=np.uint8), self._clock.now())

    def close(self) -> None:
        """Releases the camera."""
        self._device.close()

    def __str__(self) -> str:
        return "Pi camera"


def _open_device(width: int, height: int) -> Any:
    try:
        picamera2 = import_module("picamera2")
    except ImportError as problem:
        raise CameraError(
            "the Pi camera needs picamera2, which is not installed: run `sudo apt install python3-picamera2` "
            "and let the virtual environment see the system's packages, or choose another camera in "
            "robot.toml"
        ) from problem
    try:
        device = picamera2.Picamera2()
        # libcamera's RGB888 is blue, green, red in memory, which is OpenCV's order.
        device.configure(
            device.create_video_configuration(main={"size": (width, height), "format": "RGB888"})
        )
        device.start()
    except Exception as problem:
        # picamera2 raises IndexError, RuntimeError and others, depending on what is missing.
        raise CameraError(
            f"the Pi camera does not start ({problem}); check its cable, and that no other program uses it"
        ) from problem
    return device

"""The Raspberry Pi's own camera, through picamera2."""

import logging
from importlib import import_module
from typing import Any

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
from robot_runtime.vision.pi_encoder import PiEncoder
from robot_runtime.vision.shape import describe_fit, fit

log = logging.getLogger(__name__)

BUFFERS = 2
"""Pictures that the camera fills in turn: one is searched while the next one comes. More would be older."""
NANOSECONDS = 1e9
MICROSECONDS = 1e3
"""In a ms."""


class PiCamera(Camera):
    """A camera that is asked for `rate` pictures of `width` × `height` pixels a second.

    Where the Pi's hardware encodes JPEG files, each picture has its own.
    Raises CameraError without picamera2 or a camera, and where the camera is in use.
    """

    def __init__(
        self, width: int, height: int, rate: float, clock: Clock, controls: SensorControls = NO_CONTROLS
    ) -> None:
        self._clock = clock
        self.rate = rate
        self.size = self._given = (width, height)
        self._device = _open_device(width, height, rate, _table(controls))
        self._encoder = self._open_encoder()
        known = getattr(self._device, "camera_controls", {})
        self._refused = [name for name in _table(controls) if known and name not in known]

    def read(self) -> CameraFrame:
        """Return the newest picture. Raise CameraError if the camera gives none."""
        try:
            request = self._device.capture_request()
            try:
                picture = np.ascontiguousarray(request.make_array("main")[:, :, :3], dtype=np.uint8)
                self._given = (picture.shape[1], picture.shape[0])
                jpeg = self._encode(request) if self._given == self.size else None
                stamp = request.get_metadata().get("SensorTimestamp")
            finally:
                request.release()
        except Exception as problem:
            raise CameraError(f"the Pi camera gives no picture ({problem}); check its cable") from problem
        # libcamera counts from the computer's start; a Pi never sleeps, so that this is the steady clock.
        taken = taken_at((stamp or 0) / NANOSECONDS, self._clock.now())
        return CameraFrame(fit(picture, *self.size), taken, jpeg)

    def skip(self) -> None:
        """Give the next picture back to the camera. Raise CameraError."""
        try:
            self._device.capture_request().release()
        except Exception as problem:
            raise CameraError(f"the Pi camera gives no picture ({problem}); check its cable") from problem

    def close(self) -> None:
        """Release the camera."""
        self._close_encoder()
        self._device.close()

    def __str__(self) -> str:
        width, height = self._given
        form = " as JPEG" if self._encoder is not None else ""
        notes = [describe_fit(self._given, *self.size) or f"{width} × {height}{form}"]
        if self._refused:
            notes.append(f"this libcamera does not know {', '.join(self._refused)}")
        return f"Pi camera ({'; '.join(notes)})"

    def _open_encoder(self) -> PiEncoder | None:
        """Return the Pi's encoder; None where there is none, and OpenCV encodes."""
        assert self.rate is not None
        try:
            return PiEncoder(self._device, self.rate)
        except Exception as problem:
            log.info("the Pi's JPEG encoder is not used: %s", problem)
            return None

    def _encode(self, request: Any) -> bytes | None:
        if self._encoder is None:
            return None
        try:
            return self._encoder.encode(request)
        except Exception:
            # A file that comes late would be another picture's.
            log.warning("the Pi's JPEG encoder failed; OpenCV encodes", exc_info=True)
            self._close_encoder()
            return None

    def _close_encoder(self) -> None:
        encoder, self._encoder = self._encoder, None
        if encoder is not None:
            try:
                encoder.close()
            except Exception:
                log.warning("the Pi's JPEG encoder could not be closed", exc_info=True)


def _table(controls: SensorControls) -> dict[str, float]:
    """Return libcamera's controls for what is fixed; the rest is automatic when a camera is opened."""
    table: dict[str, float] = {}
    if controls.exposure:
        table["ExposureTime"] = round(controls.exposure * MICROSECONDS)
    if controls.gain:
        table["AnalogueGain"] = controls.gain
    if controls.colour_temperature:
        table |= {"AwbEnable": False, "ColourTemperature": controls.colour_temperature}
    return table


def _open_device(width: int, height: int, rate: float, controls: dict[str, float]) -> Any:
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
        known = getattr(device, "camera_controls", controls)
        device.configure(
            device.create_video_configuration(
                main={"size": (width, height), "format": "RGB888"},
                controls={"FrameRate": rate}
                | {name: value for name, value in controls.items() if name in known},
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
    text = str(problem).lower()
    if isinstance(problem, PermissionError) or "permission" in text:
        return "put the user into the group video: `sudo usermod -aG video USER`, then start again"
    if "busy" in text or "did not acquire" in text or "in use" in text or "acquire" in text:
        return "another program uses it: end that one"
    return "check its cable, and that no other program uses it"

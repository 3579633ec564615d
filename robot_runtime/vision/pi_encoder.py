"""The JPEG encoder in the hardware of Raspberry Pis up to the 4, through picamera2."""

from importlib import import_module
from io import BufferedIOBase
from queue import Queue
from typing import Any

BITS_PER_PIXEL = 1.0
"""Of a JPEG file: 38 kB at 640 × 480, near OpenCV's quality 80."""
ENCODE_SECONDS = 0.5
"""s that a picture may take; it usually takes some ms."""


class PiEncoder:
    """An encoder of a running camera's pictures as JPEG files, `rate` a second.

    It raises ImportError or RuntimeError where there is none, and whatever else picamera2 raises.
    """

    def __init__(self, device: Any, rate: float) -> None:
        stream = device.camera_configuration()["main"]
        width, height = stream["size"]
        # By its module: picamera2.encoders names an encoder without hardware the same, as on a Pi 5.
        self._encoder = import_module("picamera2.encoders.mjpeg_encoder").MJPEGEncoder()
        self._encoder.size = (width, height)
        self._encoder.format = stream["format"]
        self._encoder.stride = stream["stride"]
        self._encoder.framerate = rate
        self._encoder.bitrate = round(BITS_PER_PIXEL * width * height * rate)
        self._files = _JpegQueue()
        self._encoder.output = import_module("picamera2.outputs").FileOutput(self._files)
        self._encoder.start()

    def encode(self, request: Any) -> bytes:
        """Return a captured request's picture as a JPEG file. Raise queue.Empty if none comes in time."""
        self._encoder.encode("main", request)
        return self._files.queue.get(timeout=ENCODE_SECONDS)

    def close(self) -> None:
        """Release the hardware."""
        self._encoder.stop()


class _JpegQueue(BufferedIOBase):
    """A file in which the encoder's thread writes each JPEG file at once."""

    def __init__(self) -> None:
        self.queue: Queue[bytes] = Queue()

    def write(self, data: Any) -> int:
        self.queue.put(bytes(data))
        return len(data)

"""The interface of all cameras."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from robot_runtime.vision.picture import Picture

STAMP_AGE_MAX = 1.0
"""s between a picture and its reading; an older stamp, or one of the future, is of another clock."""


class CameraError(Exception):
    """A camera gives no picture; the text says why and what to do.

    It is reported only if it lasts for longer than `patience` (s).
    """

    def __init__(self, text: str, patience: float = 0.0) -> None:
        super().__init__(text)
        self.patience = patience


def taken_at(stamp: float, now: float) -> float:
    """Return the time of a picture (s) by its driver's stamp; `now` where the stamp has another clock."""
    return stamp if now - STAMP_AGE_MAX < stamp <= now else now


class SensorControls(NamedTuple):
    """Settings of a sensor: exposure (ms), gain in its own unit, colour temperature (K); 0: automatic."""

    exposure: float = 0.0
    gain: float = 0.0
    colour_temperature: int = 0


NO_CONTROLS = SensorControls()
"""A sensor that chooses all by itself."""


class CameraFrame:
    """One picture, `taken` at a time (s) of the steady clock.

    `jpeg` is the camera's own JPEG file of just this picture, if it gave one. `picture` is the function that
    decodes it, or the picture that the camera gave besides.
    """

    def __init__(
        self, picture: "Picture | Callable[[], Picture]", taken: float, jpeg: bytes | None = None
    ) -> None:
        self._picture = picture
        self.taken = taken
        self.jpeg = jpeg

    @cached_property
    def picture(self) -> "Picture":
        """The picture, uint8 of shape (height, width, 3) in the order blue, green, red.

        It is decoded when it is first read. Raise CameraError if that fails.
        """
        return self._picture() if callable(self._picture) else self._picture

    @property
    def original(self) -> bytes | None:
        """The JPEG file that the picture is decoded from; None for a camera that gave the picture itself."""
        return self.jpeg if callable(self._picture) else None


class Camera(ABC):
    """A source of pictures, open from construction until `close`. Construction may raise CameraError."""

    size: tuple[int, int]
    """Width and height (pixels) of the pictures that `read` returns; it may change between two of them."""

    rate: float | None = None
    """Hz that the device was opened for; None where it gives a picture at any time."""

    @abstractmethod
    def read(self) -> CameraFrame:
        """Return the newest picture. Raise CameraError if there is none."""

    def skip(self) -> None:  # noqa: B027 - most cameras keep no pictures
        """Drop the next picture of a device that else keeps old ones. Raise CameraError if there is none."""

    @abstractmethod
    def close(self) -> None:
        """Release the device."""

    @abstractmethod
    def __str__(self) -> str:
        """Return a description of the camera."""

"""The interface of all cameras."""

from abc import ABC, abstractmethod
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
    """Returns the time of a picture (s) by its driver's stamp; `now` where that is of another clock."""
    return stamp if now - STAMP_AGE_MAX < stamp <= now else now


class CameraFrame(NamedTuple):
    """One picture, uint8 of shape (height, width, 3) in the order blue, green, red."""

    picture: "Picture"
    taken: float
    """s on the steady clock."""


class Camera(ABC):
    """A source of pictures, open from construction until `close`. Construction may raise CameraError."""

    rate: float | None = None
    """Hz that the device was opened for; None where it gives a picture at any time."""

    @abstractmethod
    def read(self) -> CameraFrame:
        """Returns the newest picture. Raises CameraError if there is none."""

    @abstractmethod
    def close(self) -> None:
        """Releases the device."""

    @abstractmethod
    def __str__(self) -> str:
        """Returns a description of the camera."""

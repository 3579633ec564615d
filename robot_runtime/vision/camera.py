"""What every camera is, whatever stands behind it."""

from abc import ABC, abstractmethod
from typing import NamedTuple

from robot_runtime.vision.colours import Picture


class CameraError(Exception):
    """A camera gives no picture; the text says why and what to do."""


class Frame(NamedTuple):
    """One picture, uint8 of shape (height, width, 3) in the order blue, green, red."""

    picture: Picture
    taken: float
    """s on the steady clock."""


class Camera(ABC):
    """A source of pictures, open from its making until `close`. Making one may raise CameraError."""

    @abstractmethod
    def read(self) -> Frame:
        """The newest picture. Raises CameraError where there is none."""

    @abstractmethod
    def close(self) -> None:
        """Give the device back."""

    @abstractmethod
    def __str__(self) -> str:
        """What it is, in words."""

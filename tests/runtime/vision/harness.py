"""Pictures and cameras to look at."""

from robot_runtime.clock import SimulatedClock
from robot_runtime.vision.camera import Camera, CameraError, Frame
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.colours import DEFAULTS
from robot_runtime.vision.picture import Picture


def drawn(time: float, card: str | None, width: int = 320, height: int = 240) -> Picture:
    """The card camera's picture at this time."""
    return CardCamera(width, height, SimulatedClock(), DEFAULTS, lambda: None).draw(time, card)


class ShakyCamera(Camera):
    """Shows one picture, or fails with what `failure` holds, as long as it does."""

    def __init__(self, picture: Picture, clock: SimulatedClock) -> None:
        self.picture = picture
        self.clock = clock
        self.failure: Exception | None = None
        self.opened = 0
        self.closed = 0

    def open(self) -> "ShakyCamera":
        self.opened += 1
        if isinstance(self.failure, CameraError):
            raise self.failure
        return self

    def read(self) -> Frame:
        if self.failure is not None:
            raise self.failure
        return Frame(self.picture, self.clock.now())

    def close(self) -> None:
        self.closed += 1

    def __str__(self) -> str:
        return "shaky camera"

"""Pictures and cameras for the vision tests."""

from collections.abc import Mapping
from typing import NamedTuple

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Box
from robot_runtime.contract.vision_settings import COLOURS, ColourRange, VisionSettings
from robot_runtime.vision.camera import Camera, CameraError, CameraFrame
from robot_runtime.vision.card_camera import CardCamera
from robot_runtime.vision.cards import make_card
from robot_runtime.vision.detector import Detector
from robot_runtime.vision.picture import Picture


class Found(NamedTuple):
    """A detection: colour, box and area."""

    colour: str
    box: Box
    area: float


def find(
    picture: Picture, wanted: str, area_min: float = 0.01, colours: Mapping[str, ColourRange] = COLOURS
) -> Found | None:
    """Run the detector with this colour first; None where it finds nothing."""
    settings = VisionSettings(colour=wanted, colours=dict(colours), area_min=area_min)
    sight = Detector(settings).search(picture)
    if sight.patch is None:
        return None
    assert sight.colour is not None
    return Found(sight.colour, sight.patch.box, sight.patch.area)


def drawn(time: float, card: str | None, width: int = 320, height: int = 240) -> Picture:
    """The card camera's picture at this time."""
    held = make_card(card, COLOURS) if card else None
    return CardCamera(width, height, SimulatedClock(), lambda: None).draw(time, held)


class ShakyCamera(Camera):
    """Shows one picture; raises `failure` as long as it is set."""

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

    def read(self) -> CameraFrame:
        if self.failure is not None:
            raise self.failure
        return CameraFrame(self.picture, self.clock.now())

    def close(self) -> None:
        self.closed += 1

    def __str__(self) -> str:
        return "shaky camera"

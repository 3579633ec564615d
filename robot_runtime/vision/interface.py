"""The vision's interface to the runtime: settings, cards, the camera's state, and detections."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from robot_runtime.config import VisionConfig
from robot_runtime.contract.card_colours import MARKER_CARD, PAINTS
from robot_runtime.contract.commands import FilmCommand
from robot_runtime.contract.documents import Detection, Event
from robot_runtime.contract.topics import Topic
from robot_runtime.contract.vision_settings import VisionSettings, marker_name
from robot_runtime.errors import RefusedError

NO_PICTURE = "no picture: "
"""The beginning of the text on a camera that fails."""
STARTING = "starting"
"""The text on a camera of which there was no picture yet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VisionOutputs:
    """Receivers of the vision's results, all called by one thread.

    While `watched` is true of a topic of pictures, `picture` gets that topic, the picture's time (s) and
    its JPEG file; `thumbnail` always gets a small picture from time to time, `snapshot` the one that
    `Vision.take_snapshot` was asked for, `film` each picture of the film, a `FilmPicture`.
    """

    detection: Callable[[Detection], None]
    event: Callable[[Event], None]
    picture: Callable[[Topic[bytes], float, bytes], None] = lambda *_: None
    thumbnail: Callable[[float, bytes], None] = lambda *_: None
    snapshot: Callable[[float, bytes], None] = lambda *_: None
    film: Callable[[float, bytes], None] = lambda *_: None
    watched: Callable[[Topic[bytes]], bool] = lambda _: False


class Vision(ABC):
    """A camera whose pictures are searched. Everything but the outputs may be used by any thread."""

    def __init__(self, config: VisionConfig, outputs: VisionOutputs) -> None:
        self.card: str | None = None
        """The name of the card that is shown to the camera."""
        self.missing = ""
        """The software without which there are no pictures, in words; empty where it is there."""
        self._config = config
        self._settings = config.settings
        self._outputs = outputs

    @property
    def settings(self) -> VisionSettings:
        """The settings in force; new ones apply, all together, from the next picture on."""
        return self._settings

    @settings.setter
    def settings(self, settings: VisionSettings) -> None:
        self._settings = settings
        self._apply_settings()

    @property
    def cards(self) -> list[str]:
        """The names of the cards that can be shown to the camera."""
        if self._config.camera not in ("card", "scene"):
            return []
        return [*dict.fromkeys([*PAINTS, *self._settings.colours]), marker_name(MARKER_CARD)]

    def show_card(self, name: str | None) -> None:
        """Show this card, or none. Raise RefusedError for another camera or an unknown card."""
        if self._config.camera not in ("card", "scene"):
            raise RefusedError(
                f"the camera is {self._config.camera!r}; cards are shown to the cameras 'scene' and 'card' "
                "alone: choose one in robot.toml, [vision] camera"
            )
        if name is not None and name not in self.cards:
            raise RefusedError(f"there is no card of colour {name!r}; there are {', '.join(self.cards)}")
        if name is not None and self.missing:
            raise RefusedError(f"there is no picture: {self.missing}")
        self.card = name
        self._apply_card()

    @property
    @abstractmethod
    def text(self) -> str:
        """The description of the camera, or of its failure after `NO_PICTURE`."""

    @abstractmethod
    def pick(self, question: dict[str, Any]) -> dict[str, Any]:
        """Return the colour range around a point of the newest picture, after the white balance.

        `question` is a `PickPoint` as a table, the answer a `ColourProposal`. No setting changes. Raise
        RefusedError, ConfigError.
        """

    @abstractmethod
    def take_snapshot(self) -> dict[str, Any]:
        """Send the newest picture at full size to the outputs; return its `time` (s, steady clock).

        Raise RefusedError where there is no picture, or an old one alone.
        """

    @abstractmethod
    def film(self, command: FilmCommand) -> None:
        """Film for `command.seconds` from now on, at its rate and quality."""

    @abstractmethod
    def refusals(self) -> list[str]:
        """Return the reasons against arming now."""

    @abstractmethod
    def start(self) -> None:
        """Begin to take pictures."""

    @abstractmethod
    def close(self) -> None:
        """Release the camera."""

    @abstractmethod
    def _apply_settings(self) -> None:
        """Pass new settings on to the search."""

    @abstractmethod
    def _apply_card(self) -> None:
        """Pass another card on to the camera."""

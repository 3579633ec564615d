"""The choice of a film for the sessions to come: made on the page, stored beside the recordings."""

import asyncio
import json
import logging
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from importlib.util import find_spec
from typing import Any, Literal, get_args

from robot_runtime.contract.commands import FilmQuality
from robot_runtime.contract.parsing import parse
from robot_runtime.contract.topics import FILM, TIME
from robot_runtime.durable_files import write_whole
from robot_runtime.transport.blocks import Block
from server.features.film.config import FilmConfig
from server.platform.errors import InsufficientStorageError
from server.platform.settings import Settings
from server.stream.feed import Feed

log = logging.getLogger(__name__)

QUALITIES: tuple[FilmQuality, ...] = get_args(FilmQuality)
Coding = Literal["h264", "jpeg"]
MINUTE_PICTURES = 900
"""Pictures a minute at 15 Hz."""
USUAL_BYTES: Mapping[Coding, Mapping[FilmQuality, float]] = {
    "h264": {
        "low": 2.0e6 / MINUTE_PICTURES,
        "medium": 3.0e6 / MINUTE_PICTURES,
        "high": 6.0e6 / MINUTE_PICTURES,
    },
    "jpeg": {
        "low": 8.0e6 / MINUTE_PICTURES,
        "medium": 10e6 / MINUTE_PICTURES,
        "high": 18e6 / MINUTE_PICTURES,
    },
}
"""Bytes a picture of 640 x 480 by coding: of a robot that swims in the simulated pool."""
PICTURES_MEASURED = 300
"""Pictures of one quality after which their size counts more than the usual one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Stored:
    """The content of the file: a choice, and bytes a picture as measured, by quality."""

    choice: FilmConfig
    picture_bytes: dict[str, float] = field(default_factory=dict)


class FilmChoice:
    """The choice in force, at first that of robot.toml; `changed` is called at every change of it.

    It measures the film that arrives, so that the size of the next one is known beforehand.
    """

    def __init__(self, settings: Settings, feed: Feed) -> None:
        self.changed: Callable[[], None] = lambda: None
        self.refusal = ""
        """The reason for which nothing is filmed whatever is chosen, in words."""
        if settings.robot.profile == "lean":
            self.refusal = "The lean profile records no film: this computer has no time for it."
        self.coding: Coding = "h264" if find_spec("av") else "jpeg"
        self.rate_max = settings.vision.stream_rate
        width, height = settings.vision.stream_size
        self._area = width * height / (640 * 480)
        self._path = settings.data.film
        self._stored = _Stored(choice=settings.section(FilmConfig))
        self._read()
        self._counts: Counter[str] = Counter()
        feed.listen(self._measure, FILM)

    @property
    def now(self) -> FilmConfig:
        """The choice in force."""
        return replace(self._stored.choice, record=False) if self.refusal else self._stored.choice

    @property
    def is_measured(self) -> bool:
        """True where the sizes are those of this robot's own films."""
        return bool(self._stored.picture_bytes)

    @property
    def picture_bytes(self) -> dict[FilmQuality, float]:
        """Bytes of one picture by quality: measured, or estimated from another quality that was."""
        measured = self._stored.picture_bytes
        usual = {quality: self._area * size for quality, size in USUAL_BYTES[self.coding].items()}
        ratios = [measured[quality] / usual[quality] for quality in QUALITIES if quality in measured]
        ratio = sum(ratios) / len(ratios) if ratios else 1.0
        return {quality: measured.get(quality, ratio * usual[quality]) for quality in QUALITIES}

    async def change(self, choice: FilmConfig) -> None:
        """Apply another choice, from now on and for later starts. Raise InsufficientStorageError."""
        await asyncio.to_thread(self._keep, replace(self._stored, choice=choice))
        self._counts.clear()
        self.changed()

    def store_sizes(self) -> None:
        """Store the sizes of the pictures that have arrived, if they are enough; not for the event loop."""
        pictures, size = self._counts["pictures"], self._counts["bytes"]
        if pictures < PICTURES_MEASURED:
            return
        self._counts.clear()
        sizes = self._stored.picture_bytes | {self._stored.choice.quality: size / pictures}
        try:
            self._keep(replace(self._stored, picture_bytes=sizes))
        except InsufficientStorageError as problem:
            log.warning("the size of the film cannot be stored: %s", problem)

    def _measure(self, block: Block) -> None:
        self._counts.update(pictures=block.count, bytes=len(block.payload) - block.count * TIME.size)

    def _keep(self, stored: _Stored) -> None:
        try:
            write_whole(self._path, json.dumps(asdict(stored)).encode(), 0o600)
        except OSError as problem:
            raise InsufficientStorageError(
                f"The choice of the film cannot be stored: {problem.strerror}. Free space on the disk."
            ) from problem
        self._stored = stored

    def _read(self) -> None:
        try:
            document: dict[str, Any] = json.loads(self._path.read_bytes())
            self._stored = parse(_Stored, document)
        except FileNotFoundError:
            pass
        except (OSError, ValueError, RecursionError) as problem:
            log.warning("%s cannot be read, robot.toml's film is in force: %s", self._path, problem)
